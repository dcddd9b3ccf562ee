#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace gonio::api {

enum class Method : std::uint8_t { Get, Post };
[[nodiscard]] constexpr std::string_view method_name(Method m) {
  return m == Method::Get ? "GET" : "POST";
}

/// What a caller may do; each includes the ones before it.
enum class Permission : std::uint8_t { Viewer, Operator };

enum class RouteId : std::uint8_t {
  Status,
  Health,
  Metrics,
  Stop,
  Stage,
  StageMove,
  StageHome,
  StageReset,
  PlanCheck,
  ScanSubmit,
  ScanList,
  ScanOne,
  ScanPoints,
  ScanBrdf,
  ScanExport,
  ScanPause,
  ScanResume,
  ScanFinish,
  ScanAbort,
  ScanSkip,
  ScanChange,
  ScanCompleteMissing,
  References,
  Instrument,
  Events,
  DetectorRead,
  Calibrations,
  CalibrationOne,
  CalibrationUse,
  CalibrationChart,
  ScanRecompute,
  AnalysisStart,
  AnalysisList,
  AnalysisOne,
  AnalysisFile,
  AnalysisCancel,
  ReferenceImport,
  ReferenceCheck,
  ReferenceOne,
  ScanChecks,
  ScanBudget,
  CalibrationMap,
};

/// One way into the daemon. A name in braces, as `{scan}`, stands for a number.
struct Route {
  RouteId id;
  Method method;
  std::string_view path;
  Permission permission;
  std::string_view takes;  ///< Content-Type that a body must declare, and a changing route always; empty: no body
  std::string_view gives;  ///< Content-Type of success; errors are application/problem+json
  bool changes;            ///< moves, writes or stops something: never from a foreign page, never by GET
  std::size_t body_limit;  ///< bytes
};

inline constexpr std::string_view kJson = "application/json";
inline constexpr std::string_view kProblemJson = "application/problem+json";
inline constexpr std::string_view kCsv = "text/csv";
inline constexpr std::string_view kEventStream = "text/event-stream";
inline constexpr std::string_view kMetricsText = "text/plain";
inline constexpr std::string_view kBytes = "application/octet-stream";
inline constexpr std::size_t kSmallBody = 4096;
inline constexpr std::size_t kPlanBody = 8U << 20U;

/// All routes there are: the router, the permission check, the clients and the test of openapi.yaml go by this table.
inline constexpr std::array kRoutes{
    Route{RouteId::Status, Method::Get, "/api/v1/status", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::Health, Method::Get, "/api/v1/health", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::Metrics, Method::Get, "/api/v1/metrics", Permission::Viewer, "", kMetricsText, false, 0},
    Route{RouteId::Stop, Method::Post, "/api/v1/stop", Permission::Viewer, kJson, kJson, true, kSmallBody},
    Route{RouteId::Stage, Method::Get, "/api/v1/stage", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::StageMove, Method::Post, "/api/v1/stage/move", Permission::Operator, kJson, kJson, true, kSmallBody},
    Route{RouteId::StageHome, Method::Post, "/api/v1/stage/home", Permission::Operator, kJson, kJson, true, kSmallBody},
    Route{RouteId::StageReset, Method::Post, "/api/v1/stage/reset", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::PlanCheck, Method::Post, "/api/v1/plans:check", Permission::Viewer, kJson, kJson, false, kPlanBody},
    Route{RouteId::ScanSubmit, Method::Post, "/api/v1/scans", Permission::Operator, kJson, kJson, true, kPlanBody},
    Route{RouteId::ScanList, Method::Get, "/api/v1/scans", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanOne, Method::Get, "/api/v1/scans/{scan}", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanPoints, Method::Get, "/api/v1/scans/{scan}/points", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanBrdf, Method::Get, "/api/v1/scans/{scan}/brdf", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanExport, Method::Get, "/api/v1/scans/{scan}/export", Permission::Viewer, "", kCsv, false, 0},
    Route{RouteId::ScanPause, Method::Post, "/api/v1/scans/{scan}/pause", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanResume, Method::Post, "/api/v1/scans/{scan}/resume", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanFinish, Method::Post, "/api/v1/scans/{scan}/finish", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanAbort, Method::Post, "/api/v1/scans/{scan}/abort", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanSkip, Method::Post, "/api/v1/scans/{scan}/skip", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanChange, Method::Post, "/api/v1/scans/{scan}/change", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::ScanCompleteMissing, Method::Post, "/api/v1/scans/{scan}/complete-missing", Permission::Operator,
          kJson, kJson, true, kSmallBody},
    Route{RouteId::References, Method::Get, "/api/v1/references", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::Instrument, Method::Get, "/api/v1/instrument", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::Events, Method::Get, "/api/v1/events", Permission::Viewer, "", kEventStream, false, 0},
    Route{RouteId::DetectorRead, Method::Post, "/api/v1/detector/read", Permission::Operator, kJson, kJson, true,
          kSmallBody},
    Route{RouteId::Calibrations, Method::Get, "/api/v1/calibrations", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::CalibrationOne, Method::Get, "/api/v1/calibrations/{version}", Permission::Viewer, "", kJson, false,
          0},
    Route{RouteId::CalibrationUse, Method::Post, "/api/v1/calibrations/{version}/use", Permission::Operator, kJson,
          kJson, true, kSmallBody},
    Route{RouteId::CalibrationChart, Method::Get, "/api/v1/calibration-chart", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanRecompute, Method::Post, "/api/v1/scans/{scan}/recompute", Permission::Operator, kJson, kJson,
          true, kSmallBody},
    Route{RouteId::AnalysisStart, Method::Post, "/api/v1/analysis", Permission::Viewer, kJson, kJson, true, kPlanBody},
    Route{RouteId::AnalysisList, Method::Get, "/api/v1/analysis", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::AnalysisOne, Method::Get, "/api/v1/analysis/{job}", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::AnalysisFile, Method::Get, "/api/v1/analysis/{job}/file", Permission::Viewer, "", kBytes, false, 0},
    Route{RouteId::AnalysisCancel, Method::Post, "/api/v1/analysis/{job}/cancel", Permission::Viewer, kJson, kJson,
          true, kSmallBody},
    Route{RouteId::ReferenceImport, Method::Post, "/api/v1/references", Permission::Operator, kJson, kJson, true,
          kPlanBody},
    Route{RouteId::ReferenceCheck, Method::Post, "/api/v1/references:check", Permission::Viewer, kJson, kJson, false,
          kPlanBody},
    Route{RouteId::ReferenceOne, Method::Get, "/api/v1/reference", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanChecks, Method::Get, "/api/v1/scans/{scan}/checks", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::ScanBudget, Method::Get, "/api/v1/scans/{scan}/budget", Permission::Viewer, "", kJson, false, 0},
    Route{RouteId::CalibrationMap, Method::Get, "/api/v1/calibrations/{version}/map", Permission::Viewer, "", kBytes,
          false, 0},
};

constexpr bool routes_are_in_order() {
  for (std::size_t i = 0; i < kRoutes.size(); ++i) {
    if (static_cast<std::size_t>(kRoutes[i].id) != i) return false;
  }
  return true;
}
static_assert(routes_are_in_order());

[[nodiscard]] constexpr const Route& route(RouteId id) {
  return kRoutes[static_cast<std::size_t>(id)];
}

}  // namespace gonio::api
