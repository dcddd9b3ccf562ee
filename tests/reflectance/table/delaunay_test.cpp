#include "reflectance/table/delaunay.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "reflectance/table/triangle_search.h"

namespace gonio::reflectance {
namespace {

using Points = std::vector<PlanePoint>;

std::size_t at(std::int32_t k) {
  return static_cast<std::size_t>(k);
}

double unit(std::mt19937_64& engine) {
  return static_cast<double>(engine() >> 11) * 0x1p-53;
}

double area(const Points& p, const MeshTriangle& t) {
  const PlanePoint& a = p[at(t.corner[0])];
  const PlanePoint& b = p[at(t.corner[1])];
  const PlanePoint& c = p[at(t.corner[2])];
  return 0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x));
}

// Of the convex hull, by Andrew's monotone chain: independent of the triangulation.
double hull_area(Points p) {
  std::sort(p.begin(), p.end(),
            [](const PlanePoint& a, const PlanePoint& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  const auto turn = [](const PlanePoint& o, const PlanePoint& a, const PlanePoint& b) {
    return (a.x - o.x) * (b.y - o.y) - (a.y - o.y) * (b.x - o.x);
  };
  Points hull;
  for (int side = 0; side < 2; ++side) {
    const std::size_t base = hull.size();
    for (const PlanePoint& q : p) {
      while (hull.size() >= base + 2 && turn(hull[hull.size() - 2], hull.back(), q) <= 0.0) hull.pop_back();
      hull.push_back(q);
    }
    hull.pop_back();
    std::reverse(p.begin(), p.end());
  }
  double twice = 0.0;
  for (std::size_t k = 0; k < hull.size(); ++k) {
    const PlanePoint& b = hull[(k + 1) % hull.size()];
    twice += hull[k].x * b.y - hull[k].y * b.x;
  }
  return 0.5 * twice;
}

// How far `p` reaches into the circle through the corners, as a share of its radius; below 0 outside.
double reach_into_circle(const Points& all, const MeshTriangle& t, const PlanePoint& p) {
  const PlanePoint& a = all[at(t.corner[0])];
  const double bx = all[at(t.corner[1])].x - a.x;
  const double by = all[at(t.corner[1])].y - a.y;
  const double cx = all[at(t.corner[2])].x - a.x;
  const double cy = all[at(t.corner[2])].y - a.y;
  const double d = 2.0 * (bx * cy - by * cx);
  const double ux = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / d;
  const double uy = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / d;
  const double radius = std::hypot(ux, uy);
  return 1.0 - std::hypot(p.x - a.x - ux, p.y - a.y - uy) / radius;
}

struct Cloud {
  std::string name;
  Points points;
};

std::vector<Cloud> clouds() {
  std::vector<Cloud> list;
  std::mt19937_64 engine(7);
  Points random;
  for (int k = 0; k < 300; ++k) random.push_back({unit(engine) * 2.0 - 1.0, unit(engine) * 2.0 - 1.0});
  list.push_back({"300 points anywhere, seed 7", random});
  Points square;
  for (int x = -8; x <= 8; ++x) {
    for (int y = -8; y <= 8; ++y) square.push_back({x / 8.0, y / 8.0});
  }
  list.push_back({"a square grid, each cell cocircular", square});
  Points polar{{0.0, 0.0}};
  for (int ring = 1; ring <= 9; ++ring) {
    for (int k = 0; k < 24; ++k) {
      const double phi = 2.0 * std::numbers::pi * k / 24.0;
      polar.push_back({ring / 9.0 * std::cos(phi), ring / 9.0 * std::sin(phi)});
    }
  }
  list.push_back({"a polar grid, each ring cocircular", polar});
  Points cluster = polar;
  for (int ring = 1; ring <= 12; ++ring) {
    for (int k = 0; k < 36; ++k) {
      const double phi = 2.0 * std::numbers::pi * k / 36.0;
      cluster.push_back({0.3 + 1e-3 * ring * std::cos(phi), 0.1 + 1e-3 * ring * std::sin(phi)});
    }
  }
  list.push_back({"a polar grid with a dense cluster", cluster});
  Points lines;
  for (int k = -50; k <= 50; ++k) lines.push_back({k / 50.0, 0.0});
  lines.push_back({0.0, 1.0});
  list.push_back({"a line and one point beside it", lines});
  Points near;
  for (int k = 0; k < 40; ++k) near.push_back({unit(engine) * 1e-4, unit(engine) * 1e-4});
  near.push_back({1.0, 1.0});
  near.push_back({-1.0, 0.5});
  list.push_back({"points 1e-5 apart with two far away", near});
  return list;
}

TEST(Delaunay, FillsTheConvexHullWithTrianglesWhoseCirclesAreEmpty) {
  for (const Cloud& cloud : clouds()) {
    SCOPED_TRACE(cloud.name);
    const std::vector<MeshTriangle> triangles = delaunay(cloud.points).value();

    double total = 0.0;
    std::set<std::int32_t> used;
    for (const MeshTriangle& t : triangles) {
      EXPECT_GT(area(cloud.points, t), 0.0);
      total += area(cloud.points, t);
      used.insert(t.corner.begin(), t.corner.end());
      for (const PlanePoint& p : cloud.points) {
        if (reach_into_circle(cloud.points, t, p) > 1e-3) ADD_FAILURE() << p.x << ", " << p.y << " in a circle";
      }
    }
    EXPECT_EQ(used.size(), cloud.points.size()) << "each point is a corner";
    EXPECT_NEAR(total / hull_area(cloud.points), 1.0, 1e-5);
  }
}

TEST(Delaunay, NamesNeighboursOnBothSidesOfEachEdge) {
  for (const Cloud& cloud : clouds()) {
    SCOPED_TRACE(cloud.name);
    const std::vector<MeshTriangle> triangles = delaunay(cloud.points).value();
    for (std::size_t t = 0; t < triangles.size(); ++t) {
      for (std::size_t k = 0; k < 3; ++k) {
        const std::int32_t n = triangles[t].neighbour[k];
        if (n == MeshTriangle::kNone) continue;
        const auto& back = triangles[at(n)].neighbour;
        const auto side = std::find(back.begin(), back.end(), static_cast<std::int32_t>(t)) - back.begin();
        ASSERT_LT(side, 3);
        EXPECT_EQ(triangles[at(n)].corner[(at(static_cast<std::int32_t>(side)) + 1) % 3],
                  triangles[t].corner[(k + 2) % 3]);
      }
    }
  }
}

TEST(Delaunay, RefusesPointsOnOneLine) {
  EXPECT_FALSE(delaunay(Points{}).has_value());
  EXPECT_FALSE(delaunay(Points{{0.0, 0.0}, {0.5, 0.5}}).has_value());
  const auto line = delaunay(Points{{0.0, 0.0}, {0.25, 0.125}, {0.5, 0.25}, {-1.0, -0.5}});
  ASSERT_FALSE(line.has_value());
  EXPECT_EQ(line.error().seen, "4 directions on one line");
}

TEST(TriangleSearch, FindsCornersAndPlacesBetweenThem) {
  std::mt19937_64 engine(11);
  for (const Cloud& cloud : clouds()) {
    SCOPED_TRACE(cloud.name);
    const TriangleSearch search(cloud.points, delaunay(cloud.points).value());
    for (std::size_t k = 0; k < cloud.points.size(); ++k) {
      const MeshPlace place = search.locate(cloud.points[k]);
      double own = 0.0;
      for (std::size_t c = 0; c < 3; ++c) own += at(place.corner[c]) == k ? place.weight[c] : 0.0;
      EXPECT_NEAR(own, 1.0, 1e-6) << "corner " << k;
    }
    for (int k = 0; k < 2000; ++k) {
      const PlanePoint p{unit(engine) * 2.0 - 1.0, unit(engine) * 2.0 - 1.0};
      const MeshPlace place = search.locate(p);
      PlanePoint back;
      for (std::size_t c = 0; c < 3; ++c) {
        EXPECT_GE(place.weight[c], 0.0);
        back.x += place.weight[c] * cloud.points[at(place.corner[c])].x;
        back.y += place.weight[c] * cloud.points[at(place.corner[c])].y;
      }
      if (place.is_inside) {
        EXPECT_NEAR(back.x, p.x, 1e-11);
        EXPECT_NEAR(back.y, p.y, 1e-11);
      } else {
        for (const PlanePoint& q : cloud.points) {
          EXPECT_LE(std::hypot(back.x - p.x, back.y - p.y), std::hypot(q.x - p.x, q.y - p.y) + 1e-12);
        }
      }
    }
  }
}

}  // namespace
}  // namespace gonio::reflectance
