#pragma once

#include <string>

#include "base/clock.h"
#include "base/result.h"
#include "daemon/desks/reference_shelf.h"
#include "protocol/api/reports.h"
#include "protocol/api/requests.h"

namespace gonio::daemon {

/// A file of the shelf in the words of the API.
[[nodiscard]] api::ReferenceReport reference_report(const ShelfEntry& entry);
/// With certificate, modes and text. Errors: NotFound (and those there are), and what is wrong with the file.
[[nodiscard]] Result<api::ReferenceReport> reference_in_full(const ReferenceShelf& shelf, const std::string& serial);

/// What an import would bring, whatever the verdict on its table. Errors: those of import_reference; NotFound for
/// `shape_of`.
[[nodiscard]] Result<api::ReferenceReport> check_import(const api::ReferenceImport& request,
                                                        const ReferenceShelf& shelf);
/// Puts it on the shelf. Errors: as check_import, demand_consistency and ReferenceShelf::put.
[[nodiscard]] Result<api::ReferenceReport> import_to_shelf(const api::ReferenceImport& request,
                                                           const ReferenceShelf& shelf, UtcTime now);

}  // namespace gonio::daemon
