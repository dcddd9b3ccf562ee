// Directions in the words of others: printed values, and the way there and back.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "reflectance/convention/forward_angles.h"
#include "reflectance/convention/hapke_angles.h"
#include "reflectance/convention/nbs160_angles.h"
#include "reflectance/convention/rusinkiewicz_angles.h"
#include "reflectance/convention/specular_centred_angles.h"
#include "tests/reflectance/generated.h"

namespace gonio::reflectance {
namespace {

using namespace gonio::literals;

// The arc between where a direction was and where it came back.
double arc(const Direction& a, const Direction& b) {
  return phase_angle(a, b).si();
}

std::string text_of(const Direction& d) {
  return ::testing::PrintToString(d.theta().si()) + " " + ::testing::PrintToString(d.phi().si());
}

struct Convention {
  std::string name;
  std::function<Result<DirectionPair>(const DirectionPair&)> there_and_back;
  bool keeps_phi_i;
};

// Hapke and the forward azimuth say nothing of phi_i: the test gives it back to them.
std::vector<Convention> conventions() {
  return {
      {"Hapke", [](const DirectionPair& p) { return from_hapke(to_hapke(p.i, p.r), p.i.phi()); }, false},
      {"NBS 160", [](const DirectionPair& p) { return from_nbs160(to_nbs160(p.i, p.r)); }, true},
      {"Rusinkiewicz", [](const DirectionPair& p) { return from_rusinkiewicz(to_rusinkiewicz(p.i, p.r)); }, true},
      {"specular-centred", [](const DirectionPair& p) { return from_specular_centred(to_specular_centred(p.i, p.r)); },
       true},
      {"forward at 0", [](const DirectionPair& p) { return from_forward(to_forward(p.i, p.r), p.i.phi()); }, false},
  };
}

// A sample that returns light to where it came from: one bright reading at (30, 30, 0), dark elsewhere.
TEST(Conventions, PutASingleBrightReadingIntoTheRightPlaceAndFindItAgain) {
  const Direction i = Direction::from_angles(30.0_deg, 0.0_deg);
  const Direction r = Direction::from_angles(30.0_deg, 0.0_deg);

  const HapkeAngles hapke = to_hapke(i, r);
  const Nbs160Angles nbs = to_nbs160(i, r);
  const RusinkiewiczAngles half = to_rusinkiewicz(i, r);
  const SpecularCentredAngles specular = to_specular_centred(i, r);
  const ForwardAngles forward = to_forward(i, r);

  EXPECT_EQ(hapke, (HapkeAngles{.i = 30.0_deg, .e = 30.0_deg, .psi = 0.0_deg, .g = 0.0_deg}));
  EXPECT_EQ(nbs, (Nbs160Angles{.theta_i = 30.0_deg, .phi_i = 0.0_deg, .theta_r = 30.0_deg, .phi_r = 0.0_deg}));
  EXPECT_NEAR(in_degrees(half.theta_h), 30.0, 1e-14);
  EXPECT_EQ(half.phi_h, 0.0_deg);
  EXPECT_EQ(half.theta_d, 0.0_deg);
  EXPECT_EQ(half.phi_d, 0.0_deg);
  EXPECT_NEAR(in_degrees(specular.radial), 60.0, 1e-13);  // beyond the normal, as far from it as the mirror direction
  EXPECT_EQ(specular.azimuth, 0.0_deg);
  EXPECT_EQ(in_degrees(forward.relative_azimuth), 180.0);

  for (const Convention& c : conventions()) {
    const Result<DirectionPair> back = c.there_and_back({.i = i, .r = r});
    ASSERT_TRUE(back) << c.name;
    EXPECT_LT(arc(back->i, i), 4e-16) << c.name;
    EXPECT_LT(arc(back->r, r), 4e-16) << c.name;
  }
}

// The same reading at the mirror's side is another one in every convention.
TEST(Conventions, TellTheMirrorsSideFromTheSources) {
  const Direction i = Direction::from_angles(30.0_deg, 0.0_deg);
  const Direction r = Direction::from_angles(30.0_deg, 180.0_deg);

  EXPECT_NEAR(in_degrees(to_hapke(i, r).psi), 180.0, 1e-13);
  EXPECT_NEAR(in_degrees(to_hapke(i, r).g), 60.0, 1e-13);
  EXPECT_EQ(to_rusinkiewicz(i, r).theta_h, 0.0_deg);
  EXPECT_NEAR(in_degrees(to_rusinkiewicz(i, r).theta_d), 30.0, 1e-13);
  EXPECT_EQ(to_specular_centred(i, r).radial, 0.0_deg);
  EXPECT_EQ(to_forward(i, r).relative_azimuth, 0.0_deg);
}

struct Row {
  double theta_i, phi_i, theta_r, phi_r;
  double theta_h, phi_h, theta_d, phi_d;
  double radial, azimuth;
};

// By rotation matrices with 40 digits (reference_values.py).
const Row kRows[] = {
    {30, 0, 45, 60, 33.7340878774128458, 35.6571298247327909, 18.9469662920264183, -116.146650877354592,
     64.176792177635243, 42.8675731483630267},
    {10, -170, 80, 160, 44.5024028418269366, 164.373700424738613, 35.6954710549194915, 172.604603836231595,
     88.6871812219702734, -29.5072154023109647},
    {89.5, 20, 60, -159.99, 14.7500103722289966, 19.9353406411400296, 74.7499992555036279, 0.067016736726102298,
     29.5000015346969558, -0.0175870011541403273},
    {75, 45, 0.5, -100, 37.2958640388768144, 44.7008878673516354, 37.7048831346738928, 0.472407957532080035,
     74.5906183824068783, -0.297479693697464311},
    {55, 30, 55, 210.001, 0.000714074003325022778, -59.9995, 54.9999999968842644, 90.0, 0.000819152044285571282,
     -89.9997132117818196},
    {20, 0, 70, 180, 25.0, 180.0, 45.0, 180.0, 50.0, 180.0},
};

TEST(RusinkiewiczAngles, AreThoseOfRotationsWithFortyDigits) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.theta_r);
    const RusinkiewiczAngles a = to_rusinkiewicz(Direction::from_angles(degrees(row.theta_i), degrees(row.phi_i)),
                                                 Direction::from_angles(degrees(row.theta_r), degrees(row.phi_r)));

    // An azimuth in degrees is rounded by 1.4e-14 deg near 180, which phi_h feels 1 / sin(theta_h) times.
    const double felt = 1e-13 / std::sin(a.theta_h.si());
    EXPECT_NEAR(in_degrees(a.theta_h), row.theta_h, 5e-14);
    EXPECT_NEAR(in_degrees(a.phi_h), row.phi_h, felt);
    EXPECT_NEAR(in_degrees(a.theta_d), row.theta_d, 5e-14);
    EXPECT_NEAR(in_degrees(a.phi_d), row.phi_d, felt);
  }
}

TEST(SpecularCentredAngles, AreThoseOfRotationsWithFortyDigits) {
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.theta_r);
    const SpecularCentredAngles a =
        to_specular_centred(Direction::from_angles(degrees(row.theta_i), degrees(row.phi_i)),
                            Direction::from_angles(degrees(row.theta_r), degrees(row.phi_r)));

    EXPECT_NEAR(in_degrees(a.radial), row.radial, 5e-14);
    EXPECT_NEAR(in_degrees(a.azimuth), row.azimuth, 1e-13 / std::sin(a.radial.si()));
  }
}

TEST(Conventions, BringEveryGeneratedPairBack) {
  constexpr std::uint64_t kSeed = 20260311;
  SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
  for (const Convention& c : conventions()) {
    SCOPED_TRACE(c.name);
    GeneratedDirections directions(kSeed);
    double worst = 0.0;
    for (int k = 0; k < 20000 && !::testing::Test::HasFailure(); ++k) {
      const DirectionPair pair{.i = directions.next(), .r = directions.next()};
      SCOPED_TRACE("i " + text_of(pair.i) + ", r " + text_of(pair.r) + " rad");

      const Result<DirectionPair> back = c.there_and_back(pair);

      ASSERT_TRUE(back) << describe(back.error());
      worst = std::max({worst, arc(back->i, pair.i), arc(back->r, pair.r)});
      // Four to eight roundings of angles of up to pi: each is 2e-16 to 4e-16 rad.
      EXPECT_LT(arc(back->i, pair.i), 2e-15);
      EXPECT_LT(arc(back->r, pair.r), 2e-15);
    }
    RecordProperty("worst_arc", ::testing::PrintToString(worst));
  }
}

// Pairs on purpose: near and at retro, specular, the pole, the horizon, and opposite along the horizon.
TEST(Conventions, BringTheHardPairsBack) {
  const Angle thetas[] = {0.0_deg, radians(1e-12), radians(1e-300), 45.0_deg, degrees(90.0 - 1e-10), 90.0_deg};
  const double steps[] = {0.0, 1e-15, 1e-12, 1e-8, 1e-3};
  for (const Convention& c : conventions()) {
    for (const Angle theta : thetas) {
      for (const double step : steps) {
        for (const Angle turn : {0.0_deg, 90.0_deg, 180.0_deg, -180.0_deg}) {
          const Angle theta_r = std::min(theta + radians(step), 90.0_deg);
          const DirectionPair pair{.i = Direction::from_angles(theta, 100.0_deg),
                                   .r = Direction::from_angles(theta_r, 100.0_deg + turn + radians(step))};
          SCOPED_TRACE(c.name + ": i " + text_of(pair.i) + ", r " + text_of(pair.r) + " rad");

          const Result<DirectionPair> back = c.there_and_back(pair);

          ASSERT_TRUE(back) << describe(back.error());
          EXPECT_LT(arc(back->i, pair.i), 2e-15);
          EXPECT_LT(arc(back->r, pair.r), 2e-15);
        }
      }
    }
  }
}

TEST(RusinkiewiczAngles, KeepTheDigitsOfTheDifferenceNearRetro) {
  for (const double step : {1e-12, 1e-10, 1e-6}) {
    // Steps in theta alone near the normal, where they are exact: theta_d = step / 2 and theta_h = the middle.
    const Direction i = Direction::from_angles(radians(2.0 * step), 50.0_deg);
    const Direction r = Direction::from_angles(radians(3.0 * step), 50.0_deg);

    const RusinkiewiczAngles a = to_rusinkiewicz(i, r);

    EXPECT_NEAR(a.theta_d.si() / (0.5 * step), 1.0, 1e-15);
    EXPECT_NEAR(a.theta_h.si() / (2.5 * step), 1.0, 1e-15);
    EXPECT_EQ(in_degrees(a.phi_d), 180.0);
  }
  // And away from it by the azimuth: phi steps of 2^-40 rad are exact.
  const Direction i = Direction::from_angles(30.0_deg, radians(1.0));
  const Direction r = Direction::from_angles(30.0_deg, radians(1.0 + 0x1p-40));
  EXPECT_NEAR(to_rusinkiewicz(i, r).theta_d.si() / (0.5 * 0.5 * 0x1p-40), 1.0, 1e-15);
  // The cosine has nothing left of it.
  EXPECT_EQ(std::acos(std::min(1.0, 1.0 - 0.5 * std::pow(0x1p-41, 2))), 0.0);
}

TEST(RusinkiewiczAngles, KeepTheDigitsOfTheHalfVectorNearSpecular) {
  for (const double step : {1e-12, 1e-9, 1e-5}) {
    // In the plane of incidence theta_h is half of the difference of the thetas, which 2^-k make exact.
    const double exact = std::exp2(std::round(std::log2(step)));
    const Direction i = Direction::from_angles(radians(0.5), 0.0_deg);
    const Direction r = Direction::from_angles(radians(0.5 + exact), 180.0_deg);

    const RusinkiewiczAngles a = to_rusinkiewicz(i, r);
    const SpecularCentredAngles s = to_specular_centred(i, r);

    EXPECT_NEAR(a.theta_h.si() / (0.5 * exact), 1.0, 1e-15);
    EXPECT_NEAR(s.radial.si() / exact, 1.0, 1e-15);
    EXPECT_EQ(in_degrees(s.azimuth), 180.0);
  }
}

TEST(RusinkiewiczAngles, StandInTheirPlacesWhereAzimuthsMeanNothing) {
  const Direction pole;
  const Direction horizon = Direction::from_elevation({}, 40.0_deg);

  EXPECT_EQ(to_rusinkiewicz(pole, pole), RusinkiewiczAngles{});
  const RusinkiewiczAngles opposite = to_rusinkiewicz(horizon, mirrored(horizon));
  EXPECT_EQ(opposite.theta_h, 0.0_deg);
  EXPECT_EQ(opposite.phi_h, 0.0_deg);
  EXPECT_EQ(in_degrees(opposite.theta_d), 90.0);
  EXPECT_EQ(opposite.phi_d, 40.0_deg);
}

TEST(RusinkiewiczAngles, TurnPhiDByAHalfWhenTheDirectionsAreExchanged) {
  GeneratedDirections directions(5);
  for (int k = 0; k < 2000; ++k) {
    const Direction i = directions.next();
    const Direction r = directions.next();
    const RusinkiewiczAngles forth = to_rusinkiewicz(i, r);
    const RusinkiewiczAngles back = to_rusinkiewicz(r, i);
    SCOPED_TRACE("i " + text_of(i) + ", r " + text_of(r) + " rad");

    EXPECT_NEAR(forth.theta_h.si(), back.theta_h.si(), 1e-15);
    EXPECT_EQ(forth.theta_d, back.theta_d);
    if (forth.theta_d > 0.0_deg && forth.theta_h > radians(1e-15)) {
      EXPECT_NEAR(std::abs(wrapped(forth.phi_d - back.phi_d).si()), 3.141592653589793, 2e-15);
    }
  }
}

TEST(HapkeAngles, RefuseAPhaseAngleThatIsNotTheirs) {
  const HapkeAngles right{.i = 30.0_deg, .e = 60.0_deg, .psi = 180.0_deg, .g = 90.0_deg};
  HapkeAngles wrong = right;
  wrong.g = 89.0_deg;

  EXPECT_TRUE(from_hapke(right));
  const Result<DirectionPair> refused = from_hapke(wrong);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::InvalidInput);
  EXPECT_NE(refused.error().seen.find("g 89 deg where i, e and psi make 90"), std::string::npos)
      << refused.error().seen;
  EXPECT_TRUE(from_hapke(wrong, {}, 1.5_deg));  // a table printed to whole degrees
}

TEST(HapkeAngles, FindTheAzimuthThatAPhaseAngleImplies) {
  for (const double psi : {0.0, 0.001, 30.0, 90.0, 179.99, 180.0}) {
    const Direction i = Direction::from_angles(40.0_deg, 0.0_deg);
    const Direction r = Direction::from_angles(65.0_deg, degrees(psi));

    const Result<HapkeAngles> found = hapke_from_phase(40.0_deg, 65.0_deg, phase_angle(i, r));

    // g changes with psi as psi itself towards 0 and 180 deg: half of the digits are lost there.
    ASSERT_TRUE(found) << psi;
    EXPECT_NEAR(in_degrees(found->psi), psi, psi == 0.0 || psi == 180.0 ? 1e-6 : 1e-9);
  }
  EXPECT_EQ(hapke_from_phase(0.0_deg, 65.0_deg, 65.0_deg)->psi, 0.0_deg);
  EXPECT_FALSE(hapke_from_phase(40.0_deg, 65.0_deg, 24.9_deg));
  EXPECT_FALSE(hapke_from_phase(40.0_deg, 65.0_deg, 105.1_deg));
}

TEST(Nbs160Angles, CountAzimuthsFromZeroToATurn) {
  const Direction i = Direction::from_angles(10.0_deg, -90.0_deg);
  const Direction r = Direction::from_angles(20.0_deg, radians(-1e-300));

  const Nbs160Angles a = to_nbs160(i, r);

  EXPECT_NEAR(in_degrees(a.phi_i), 270.0, 1e-13);
  EXPECT_EQ(a.phi_r, 0.0_deg);  // a turn less 1e-300 is none
}

TEST(ForwardAngles, AreOursLessAHalfTurn) {
  const Direction i = Direction::from_angles(30.0_deg, 20.0_deg);
  const Direction r = Direction::from_angles(50.0_deg, 80.0_deg);

  // phi_r - phi_i = 60 deg: 120 deg from forward, on the other side of it.
  EXPECT_NEAR(in_degrees(to_forward(i, r).relative_azimuth), -120.0, 1e-13);
}

template <class Angles>
void expect_refused(const Result<DirectionPair>& result, const Angles&, const std::string& name) {
  ASSERT_FALSE(result) << name;
  EXPECT_EQ(result.error().code, ErrorCode::InvalidInput) << name;
  EXPECT_NE(result.error().seen.find(name), std::string::npos) << result.error().seen;
}

TEST(Conventions, RefuseAnglesThatAreNoneOrOutOfRangeByName) {
  const Angle nan = radians(std::numeric_limits<double>::quiet_NaN());
  const Angle inf = radians(std::numeric_limits<double>::infinity());
  for (const Angle bad : {nan, inf, -inf, 200.0_deg, -1.0_deg}) {
    const bool is_finite = std::isfinite(bad.si());
    SCOPED_TRACE(in_degrees(bad));
    expect_refused(from_hapke({.i = bad}), 0, "i ");
    expect_refused(from_hapke({.e = bad}), 0, "e ");
    expect_refused(from_hapke({.g = bad}), 0, "g ");
    expect_refused(from_hapke({}, {}, bad), 0, "tolerance");
    expect_refused(from_nbs160({.theta_i = bad}), 0, "theta_i");
    expect_refused(from_nbs160({.theta_r = bad}), 0, "theta_r");
    expect_refused(from_rusinkiewicz({.theta_h = bad}), 0, "theta_h");
    expect_refused(from_rusinkiewicz({.theta_d = bad}), 0, "theta_d");
    expect_refused(from_specular_centred({.theta_i = bad}), 0, "theta");
    expect_refused(from_specular_centred({.radial = bad}), 0, "radial");
    expect_refused(from_forward({.theta_i = bad}), 0, "theta_i");
    expect_refused(from_forward({.theta_r = bad}), 0, "theta_r");
    EXPECT_FALSE(hapke_from_phase(bad, 1.0_deg, 1.0_deg));
    EXPECT_FALSE(hapke_from_phase(1.0_deg, bad, 1.0_deg));
    EXPECT_FALSE(hapke_from_phase(1.0_deg, 1.0_deg, bad));
    if (is_finite) continue;  // an azimuth may be any finite angle
    expect_refused(from_hapke({.psi = bad}), 0, "psi");
    expect_refused(from_hapke({}, bad), 0, "phi_i");
    expect_refused(from_nbs160({.phi_i = bad}), 0, "phi_i");
    expect_refused(from_nbs160({.phi_r = bad}), 0, "phi_r");
    expect_refused(from_rusinkiewicz({.phi_h = bad}), 0, "phi_h");
    expect_refused(from_rusinkiewicz({.phi_d = bad}), 0, "phi_d");
    expect_refused(from_specular_centred({.phi_i = bad}), 0, "phi");
    expect_refused(from_specular_centred({.azimuth = bad}), 0, "azimuth");
    expect_refused(from_forward({.relative_azimuth = bad}), 0, "relative_azimuth");
    expect_refused(from_forward({}, bad), 0, "phi_i");
  }
}

TEST(Conventions, RefuseADirectionBelowTheHorizon) {
  const Result<DirectionPair> half = from_rusinkiewicz({.theta_h = 60.0_deg, .theta_d = 40.0_deg, .phi_d = 0.0_deg});
  ASSERT_FALSE(half);
  EXPECT_NE(half.error().seen.find("elevation -10 deg"), std::string::npos) << half.error().seen;

  EXPECT_FALSE(from_specular_centred({.theta_i = 60.0_deg, .radial = 40.0_deg, .azimuth = 180.0_deg}));
  EXPECT_TRUE(from_specular_centred({.theta_i = 60.0_deg, .radial = 40.0_deg, .azimuth = 0.0_deg}));
}

}  // namespace
}  // namespace gonio::reflectance
