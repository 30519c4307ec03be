// Shares out the time of the service thread, which all connections have in common. Each client is always
// served a little; what it takes beyond that comes from what its address, and all addresses together, may
// take. Who has taken that much is not read from until it is gained back: its requests wait in its own
// socket, and frames of others go on. Pure arithmetic on measured times: the caller passes the time `now` and
// what it spent [us].
#pragma once

#include <cstdint>
#include <map>
#include <string>

#include "server/net/pacing.h"

namespace clothlab::net {

/// Processor time of the calling thread [us]. What a busy machine keeps the thread waiting is nobody's doing.
std::int64_t thread_time_us();

/// What may be taken: it grows by `gained` [us] each second, up to `most` [us].
struct ServiceShare {
  double gained = 0, most = 0;
};

/// Of each client in any case, so that none waits for what others do; beyond that of all clients of an
/// address, and of all; of requests over plain HTTP. With 64 clients the sum leaves more than a quarter of
/// the thread to frames.
inline constexpr ServiceShare own_service{5'000, 2'000}, service_of_address{100'000, 30'000},
    service_of_all{200'000, 30'000}, http_service_of_address{100'000, 50'000},
    http_service_of_all{150'000, 100'000};

/// The time that connections of one kind share. Addresses count as request_headers.h counts them
/// (network_of).
class ServicePool {
 public:
  ServicePool(const ServiceShare& each_address, const ServiceShare& all)
      : each_(each_address), all_(all.gained, all.most, 0) {}

  /// Time until this address may be served [us]; 0: now.
  std::int64_t wait(const std::string& network, std::int64_t now) const;
  /// Takes what serving this address took; more than is left is a debt, which must be gained back first.
  void spend(const std::string& network, std::int64_t now, std::int64_t spent);

 private:
  ServiceShare each_;
  TokenBucket all_;
  std::map<std::string, TokenBucket> of_network_;
  std::int64_t forget_at_ = 0;
};

/// One client's time: its own share first, then the pool's.
class ServiceTime {
 public:
  ServiceTime(ServicePool& pool, const ServiceShare& own, std::string network, std::int64_t now)
      : pool_(pool), network_(std::move(network)), own_(own.gained, own.most, now) {}

  /// Time until the client may be served [us]; 0: now.
  std::int64_t wait(std::int64_t now) const;
  void spend(std::int64_t now, std::int64_t spent);

 private:
  ServicePool& pool_;
  std::string network_;
  TokenBucket own_;
};

}  // namespace clothlab::net
