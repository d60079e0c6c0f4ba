// Measured times in the command's documents. Sessions measure them, and know nothing of JSON.
#include "cli.hpp"
#include "rate_check.hpp"
#include "statistics.hpp"

namespace asperity::command {

json to_json(const time_summary& s) {
  return {{"count", s.count}, {"mean", s.mean_s}, {"p50", s.p50_s}, {"p99", s.p99_s}, {"max", s.max_s}};
}

json to_json(const rate_check& checked) {
  return {{"tick_time", to_json(checked.tick)},
          {"processor_p99", checked.processor_p99_s},
          {"kept", checked.kept},
          {"kept_rate", checked.kept_rate_hz ? json(*checked.kept_rate_hz) : json()}};
}

}  // namespace asperity::command
