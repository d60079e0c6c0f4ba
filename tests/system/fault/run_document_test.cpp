// The document of run: what a session tells of itself, with support planes and without.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "documents.hpp"

namespace fault {
namespace {

TEST_F(documents, run) {
  const json d = expect_document({"run", "--probe", block(), "--fixed", block(), "--seconds", "0.8", "--record",
                                  path("session.csv"), "--plot", path("session.svg")},
                                 "asperity.run/1");
  expect_keys(d, {"schema",
                  "formulation",
                  "probe",
                  "fixed",
                  "start",
                  "device",
                  "clock",
                  "motion",
                  "moves",
                  "seed",
                  "seconds",
                  "backend",
                  "gradient_scheme",
                  "grid",
                  "lookup",
                  "contacts",
                  "max_depth",
                  "probe_force",
                  "probe_torque",
                  "hand_force",
                  "hand_torque",
                  "energy",
                  "contact_loop",
                  "device_loop",
                  "tick_time_is",
                  "memory",
                  "rejected_samples",
                  "lost_records",
                  "fault",
                  "fault_record",
                  "interrupted",
                  "recording",
                  "plot",
                  "units",
                  "device_recording",
                  "replay",
                  "real_time",
                  "signal",
                  "driver_fault",
                  "rates",
                  "vibration",
                  "wall",
                  "coupling",
                  "rate_check",
                  "velocity",
                  "scale",
                  "gripper",
                  "transient",
                  "weight",
                  "clutch",
                  "friction",
                  "local_model",
                  "surfaces"});
  for (const char* loop : {"contact_loop", "device_loop"}) {
    expect_keys(d[loop], {"rate", "ticks", "idle", "late", "skipped", "over_period", "kept", "tick_time"});
  }
  expect_keys(d["rate_check"], {"tick_time", "processor_p99", "kept", "kept_rate"});
  EXPECT_EQ(d["formulation"], "planes");
  for (const char* key : {"band", "rest", "force", "torque"}) EXPECT_TRUE(d["vibration"].contains(key)) << key;
  EXPECT_EQ(d["device_loop"]["ticks"], 800);
  EXPECT_EQ(d["fault"], "none");
  EXPECT_EQ(d["interrupted"], false);
  EXPECT_TRUE(d["fault_record"].is_null());
  EXPECT_GT(d["contacts"]["share_of_ticks"], 0.3);
  EXPECT_GT(d["hand_force"]["max"], 0.1);
  EXPECT_GT(d["device_loop"]["tick_time"]["p50"], 0.0);
  EXPECT_GE(d["device_loop"]["tick_time"]["p99"], d["device_loop"]["tick_time"]["p50"]);
  EXPECT_EQ(files(), (std::set<std::string>{"session.csv", "session.svg"}));
  EXPECT_NE(read("session.svg").find("</svg>"), std::string::npos);
}

TEST_F(documents, run_without_support_planes) {
  for (const char* contacts : {"least-motion", "window"}) {
    const json d = expect_document(
        {"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.1", "--contacts", contacts}, "asperity.run/1");
    EXPECT_EQ(d["formulation"], contacts);
    EXPECT_TRUE(d["wall"].is_null());
    EXPECT_TRUE(d["local_model"].is_null());
    EXPECT_EQ(d["coupling"]["translation"]["stiffness"], 500.0);
    EXPECT_EQ(d["coupling"]["rotation"]["from"], "default");
  }
}

TEST_F(documents, what_is_of_support_planes_is_refused_with_other_contacts) {
  for (const arguments& option :
       {arguments{"--no-local-model"}, arguments{"--friction", "0.5"}, arguments{"--move", "conveyor=0.1"}}) {
    arguments session{"run", "--probe", pin(), "--fixed", pin(), "--contacts", "window"};
    session.insert(session.end(), option.begin(), option.end());
    const std::string message = expect_failure(session, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front() + " is "), std::string::npos) << message;
    EXPECT_NE(message.find("--contacts planes"), std::string::npos) << message;
  }
}

TEST_F(documents, run_with_support_planes) {
  const arguments session{"run", "--probe", pin(), "--fixed", block(), "--motion", "press"};
  arguments above = session, inside = session;
  above.insert(above.end(), {"--seconds", "0.5"});
  inside.insert(inside.end(), {"--seconds", "0.05", "--probe-pose", "0.001 0.002 0.003 0 0 0 1", "--coupling", "700"});
  const json d = expect_document(above, "asperity.run/1");
  EXPECT_EQ(d["formulation"], "planes");
  expect_keys(d["wall"], {"largest_overlap", "beyond_field", "passed", "not_held", "planes_left_out", "unbalanced",
                          "friction_left_out", "body_lost", "stands_back"});
  for (const char* flag : {"beyond_field", "passed", "not_held", "planes_left_out", "unbalanced", "friction_left_out",
                           "body_lost", "stands_back"}) {
    EXPECT_EQ(d["wall"][flag]["ticks"], 0) << flag;
    EXPECT_TRUE(d["wall"][flag]["first"].is_null()) << flag;
  }
  EXPECT_GT(d["wall"]["largest_overlap"], 0.0);
  EXPECT_LT(d["wall"]["largest_overlap"], 4e-4);
  EXPECT_EQ(d["coupling"]["translation"]["from"], "device");
  EXPECT_EQ(d["coupling"]["translation"]["stiffness"], 1500.0);  // half of what the simulated device states
  EXPECT_EQ(d["coupling"]["rotation"]["stiffness"], 5.0);
  // A probe that begins within a body is told, and so is a coupling of one's own.
  const json deep = expect_document(inside, "asperity.run/1");
  EXPECT_GT(deep["wall"]["not_held"]["ticks"], 0);
  EXPECT_EQ(deep["coupling"]["translation"]["stiffness"], 700.0);
  EXPECT_EQ(deep["coupling"]["translation"]["from"], "option");
  EXPECT_EQ(deep["coupling"]["rotation"]["from"], "device");
  // The velocity of the handle, where another than that of its poses was asked for.
  EXPECT_EQ(d["velocity"]["asked"], "poses");
  arguments own = above;
  own.insert(own.end(), {"--velocity", "device"});
  const json told = expect_document(own, "asperity.run/1");
  EXPECT_GE(told["velocity"]["device_ticks"], told["device_loop"]["ticks"]);
  EXPECT_EQ(told["velocity"]["window_ticks"], 0);
  EXPECT_EQ(told["velocity"]["refused"], false);
  EXPECT_LE(told["energy"]["largest_surplus"], 1e-5);
  // Motion scaling and a clutch, which the simulated hand uses for a fifth of the session.
  EXPECT_EQ(d["scale"], 1.0);
  EXPECT_TRUE(d["clutch"].is_null());
  arguments large = session;
  large.insert(large.end(), {"--scale", "5", "--clutch", "2", "--seconds", "1.5"});
  const json scaled = expect_document(large, "asperity.run/1");
  EXPECT_EQ(scaled["scale"], 5.0);
  EXPECT_EQ(scaled["clutch"]["button"], 2);
  EXPECT_EQ(scaled["clutch"]["told"], true);
  EXPECT_NEAR(scaled["clutch"]["let_go"], 0.15, 0.01);  // of 0.3 s the second half, the first is the ramp
  EXPECT_NEAR(scaled["coupling"]["translation"]["stiffness"], 60.0, 1e-9);
  EXPECT_LE(scaled["energy"]["largest_surplus"], 1e-5);
  EXPECT_EQ(scaled["fault"], "none");
  EXPECT_TRUE(d["gripper"].is_null());  // the simulated device has none
  // The handle's weight, held up by the motors.
  EXPECT_TRUE(d["weight"].is_null());
  arguments heavy = above;
  heavy.insert(heavy.end(), {"--weight", "0.2,0,0,0.03"});
  const json held = expect_document(heavy, "asperity.run/1");
  EXPECT_EQ(held["weight"]["mass"], 0.2);
  EXPECT_EQ(held["weight"]["centre"][2], 0.03);
  EXPECT_NE(held["energy"]["of_weight"], 0.0);
  EXPECT_LE(held["energy"]["largest_surplus"], 1e-5);
  EXPECT_EQ(held["fault"], "none");
  arguments too_heavy = above;
  too_heavy.insert(too_heavy.end(), {"--weight", "0.6"});
  EXPECT_NE(expect_failure(too_heavy, 1, "invalid_argument").find("more than half"), std::string::npos);
  // What a first touch rings with.
  EXPECT_TRUE(d["transient"].is_null());
  EXPECT_EQ(d["energy"]["of_transients"], 0.0);
  arguments ringing = above;
  ringing.insert(ringing.end(), {"--transient", "20,120"});
  const json rang = expect_document(ringing, "asperity.run/1");
  EXPECT_EQ(rang["transient"]["amplitude"], 20.0);
  EXPECT_EQ(rang["transient"]["frequency"], 120.0);
  EXPECT_GE(rang["transient"]["first_touches"], 1);
  EXPECT_LE(rang["energy"]["largest_surplus"], 1e-5);
  // Friction, where it was asked for.
  EXPECT_TRUE(d["friction"].is_null());
  arguments rough = above;
  rough.insert(rough.end(), {"--friction", "0.6,0.4"});
  const json rubbed = expect_document(rough, "asperity.run/1");
  EXPECT_EQ(rubbed["friction"]["static"], 0.6);
  EXPECT_EQ(rubbed["friction"]["dynamic"], 0.4);
  EXPECT_LE(rubbed["energy"]["largest_surplus"], 1e-5);
  // Planes that stay between two contacts feel otherwise.
  EXPECT_EQ(d["local_model"], true);
  arguments stay = above;
  stay.insert(stay.end(), {"--no-local-model"});
  const json stayed = expect_document(stay, "asperity.run/1");
  EXPECT_EQ(stayed["local_model"], false);
  EXPECT_NE(stayed["hand_force"]["max"], d["hand_force"]["max"]);
}

}  // namespace
}  // namespace fault
