#include "daemon/store/store_actor.h"

namespace gonio::daemon {

StoreActor::Answer StoreActor::on(const StoreRequest& request, Instant /*now*/) {
  if (const auto* commit = std::get_if<Commit>(&request)) {
    return CommitAnswer{.ticket = commit->ticket, .receipt = writer_.commit(commit->transaction)};
  }
  return UnfinishedAnswer{.ticket = std::get<LoadUnfinished>(request).ticket, .scans = writer_.unfinished()};
}

}  // namespace gonio::daemon
