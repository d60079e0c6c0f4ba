// The output gate's function, proved: compiled by clang, translated to SMT-LIB, decided by cvc5 for every bit pattern.
// See docs/explanation/gate-proof.md.
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <gtest/gtest.h>
#include <map>
#include <optional>
#include <string>
#include <unistd.h>
#include <utility>
#include <vector>

#include "proof/gate/ir_to_smt.hpp"
#include "proof/gate/tools.hpp"

namespace {

using namespace asperity::proof;
using asperity::result;

const std::vector<std::string> inputs{"wanted_x",   "wanted_y", "wanted_z",   "previous_x", "previous_y",
                                      "previous_z", "limit",    "saturation", "max_change", "allowed"};
const std::vector<std::string> outputs{"out_x", "out_y", "out_z", "finite", "certified"};

// The one assumption of the first two: the limit is an ordinary number up to a million. Nothing is assumed of the
// wanted and the previous vector, the saturation, the change, or the flag.
std::string assume_limit() { return "(assert (fp.leq (fp.abs limit) " + smt_literal(1e6) + "))\n"; }

// 1: some output is NaN or infinite.
const std::string not_finite =
    "(or (fp.isNaN out_x) (fp.isInfinite out_x) (fp.isNaN out_y) (fp.isInfinite out_y) (fp.isNaN out_z)"
    " (fp.isInfinite out_z))";

// 2: the squared length of what leaves, in the very arithmetic of the certificate, is above the limit's.
std::string too_long() {
  return "(not (fp.leq (fp.add RNE (fp.mul RNE out_z out_z) (fp.add RNE (fp.mul RNE out_x out_x) (fp.mul RNE out_y "
         "out_y))) (fp.mul RNE (fp.mul RNE limit limit) " +
         smt_literal(1.00000001) + ")))";
}

// 3: at rest, a command that is stale or not finite leaves something other than zero, or passes for finite.
const std::string from_rest = "(assert (and (fp.isZero previous_x) (fp.isZero previous_y) (fp.isZero previous_z)))\n";
const std::string odd =
    "(or (fp.isNaN wanted_x) (fp.isInfinite wanted_x) (fp.isNaN wanted_y) (fp.isInfinite wanted_y)"
    " (fp.isNaN wanted_z) (fp.isInfinite wanted_z))";
const std::string leaves = "(not (and (fp.isZero out_x) (fp.isZero out_y) (fp.isZero out_z)))";

bool is_odd(const std::array<double, 5>& out) {
  return !std::isfinite(out[0]) || !std::isfinite(out[1]) || !std::isfinite(out[2]);
}

std::string ordinary_bounds() {
  const std::string ten = smt_literal(10.0);
  return "(assert (and (= limit " + ten + ") (= saturation " + ten + ") (= max_change " + smt_literal(100.0) + ")))\n";
}

// The flag and the truth differ.
std::string wrongly_finite() {
  std::string ordinary = "(and";
  for (const char* const axis : {"wanted_x", "wanted_y", "wanted_z"}) {
    ordinary += std::string(" (fp.leq (fp.abs ") + axis + ") " + smt_literal(1e150) + ')';
  }
  return "(not (= (= finite " + smt_literal(1.0) + ") " + ordinary + ")))";
}

const std::string all_zero = "(assert (and (= out_x out_y out_z) (fp.isZero out_x)))\n";

std::string certified(double x) { return "(assert (= certified " + smt_literal(x) + "))\n"; }

bool is_long(const std::array<double, 5>& out, double limit) {
  return out[0] * out[0] + out[1] * out[1] + out[2] * out[2] > limit * limit * 1.00000001;
}

enum class form { ieee754, any_arithmetic };

// Addition and multiplication as functions of which nothing is known: proves for every arithmetic, IEEE 754's among
// them.
std::string any_arithmetic(std::string smt) {
  for (const auto& [from, to] : {std::pair<std::string, std::string>{"fp.add RNE", "add"}, {"fp.mul RNE", "mul"}}) {
    for (std::size_t at = smt.find(from); at != std::string::npos; at = smt.find(from)) smt.replace(at, 10, to);
  }
  const std::string real = " ((_ FloatingPoint 11 53) (_ FloatingPoint 11 53)) (_ FloatingPoint 11 53))\n";
  return "(declare-fun add" + real + "(declare-fun mul" + real + smt;
}

class prove_gate : public testing::Test {
 protected:
  prove_gate() {
    clang_ = find_tool({"clang++-14"});
    solver_ = find_tool({"cvc5"});
    folder_ = std::filesystem::temp_directory_path() / ("asperity_prove_gate_" + std::to_string(::getpid()) + '_' +
                                                        testing::UnitTest::GetInstance()->current_test_info()->name());
  }
  ~prove_gate() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  bool compile(const std::vector<change>& changes) {
    std::filesystem::create_directories(folder_);
    result<compiled_gate> compiled = compile_gate(*clang_, folder_, changes);
    EXPECT_TRUE(compiled) << compiled.error().message;
    if (compiled) gate_ = *compiled;
    return compiled.has_value();
  }

  // Compiles, translates, asks. The report says what was decided and how long it took.
  verdict decide(const std::vector<change>& changes, cut what, const std::string& assumed,
                 const std::string& violation) {
    if (!compile(changes)) return {};
    const result<translation> t = to_smt(gate_.ir, inputs, outputs, what);
    EXPECT_TRUE(t) << t.error().message;
    if (!t) return {};
    EXPECT_EQ(t->cuts, what == cut::before_outputs ? 3U : what == cut::quotients_and_roots ? 4U : 0U);
    const bool real = form_ == form::ieee754;
    const std::string question = t->smt + assumed + "(assert " + violation + ")\n";
    const verdict v = ask(*solver_, folder_, real ? question : any_arithmetic(question), inputs, 120);
    std::printf("%zu lines of IR, %zu values cut: %s in %.1f s\n", t->lines, t->cuts,
                v.said == answer::proved    ? "proved"
                : v.said == answer::refuted ? "counter-example"
                                            : "undecided",
                v.seconds);
    EXPECT_NE(v.said, answer::undecided) << v.text;
    return v;
  }

  // A broken copy: there has to be a counter-example, and the compiled copy has to do with it what the solver says.
  std::array<double, 5> counter_example(const std::vector<change>& changes, const std::string& assumed,
                                        const std::string& violation) {
    const verdict v = decide(changes, cut::nothing, assumed, violation);
    if (v.said != answer::refuted) {
      ADD_FAILURE() << "no counter-example";
      return {};
    }
    for (const std::string& name : inputs) {
      const auto found = v.inputs.find(name);
      std::printf("  %s = %s\n", name.c_str(), found == v.inputs.end() ? "?" : found->second.c_str());
    }
    const auto out = call(gate_, inputs, v.inputs);
    EXPECT_TRUE(out) << "the compiled gate did not answer";
    if (!out) return {};
    std::printf("  compiled: (%g, %g, %g), finite %g, certified %g\n", (*out)[0], (*out)[1], (*out)[2], (*out)[3],
                (*out)[4]);
    found_ = v.inputs;
    return *out;
  }

  double found(const char* name) const {
    return std::bit_cast<double>(
        static_cast<std::uint64_t>(std::stoull(found_.count(name) > 0 ? found_.at(name) : "0", nullptr, 16)));
  }

  std::optional<std::string> clang_;
  std::optional<std::string> solver_;
  std::filesystem::path folder_;
  compiled_gate gate_;
  form form_ = form::ieee754;
  std::map<std::string, std::string> found_;
};

#define NEEDS_TOOLS()                                                                              \
  if (!clang_) GTEST_SKIP() << "clang++-14 is missing (Debian: clang-14); its IR is what is read"; \
  if (!solver_) GTEST_SKIP() << "cvc5 is missing (Debian: cvc5)"

TEST_F(prove_gate, never_nan_or_infinite) {
  NEEDS_TOOLS();
  EXPECT_EQ(decide({}, cut::before_outputs, assume_limit(), not_finite).said, answer::proved);
}

// In two questions. What passed the certificate is what it measured: that needs no arithmetic, only that the same
// operation on the same numbers gives the same number, so the solver is told nothing else about + and *. What did not
// pass is zero, whose length is within every limit.
TEST_F(prove_gate, never_longer_than_the_limit) {
  NEEDS_TOOLS();
  form_ = form::any_arithmetic;
  EXPECT_EQ(decide({}, cut::before_outputs, certified(1.0), too_long()).said, answer::proved);
  form_ = form::ieee754;
  EXPECT_EQ(decide({}, cut::before_outputs, certified(0.0), leaves).said, answer::proved);
  EXPECT_EQ(decide({}, cut::before_outputs, assume_limit() + certified(0.0) + all_zero, too_long()).said,
            answer::proved);
}

// Whatever the factors that shorten are: zero times them is zero, or fails the certificate.
TEST_F(prove_gate, stale_or_not_finite_from_rest_is_exactly_zero) {
  NEEDS_TOOLS();
  EXPECT_EQ(decide({}, cut::quotients_and_roots, from_rest + "(assert (or (not allowed) " + odd + "))\n", leaves).said,
            answer::proved);
}

// Ordinary means below 1e150: a vector longer than that is not believed either.
TEST_F(prove_gate, says_truly_whether_the_wanted_vector_is_finite) {
  NEEDS_TOOLS();
  EXPECT_EQ(decide({}, cut::nothing, "", wrongly_finite()).said, answer::proved);
}

// A function that always answers zero has all of the above. What is within every limit leaves as it came.
TEST_F(prove_gate, lets_through_what_is_within_the_limits) {
  NEEDS_TOOLS();
  ASSERT_TRUE(compile({}));
  const std::array<double, 9> in{1.0, -2.0, 0.5, 0.0, 0.0, 0.0, 10.0, 10.0, 5.0};
  std::map<std::string, std::string> named{{"allowed", "1"}};
  for (std::size_t i = 0; i < in.size(); ++i) named[inputs[i]] = hex(in[i]);
  const auto out = call(gate_, inputs, named);
  ASSERT_TRUE(out);
  EXPECT_EQ(*out, (std::array<double, 5>{1.0, -2.0, 0.5, 1.0, 1.0}));
}

// Broken copies. Each loses what its line is there for; where the solver found nothing, the proofs above would mean
// nothing. The solver searches the whole broken function, which lets it go through few multipliers: the slew is taken
// out of the copies, and one axis is searched where one is enough.
std::vector<change> broken(std::vector<change> changes) {
  for (const char* const axis : {"x", "y", "z"}) {
    const std::string a = axis;
    changes.push_back({a + " = previous." + a + " + d" + a + " * part;", a + " += 0.0;"});
  }
  return changes;
}
const change without_certificate{"{certified ? x : 0.0, certified ? y : 0.0, certified ? z : 0.0}", "{x, y, z}"};
const std::string along_x = "(assert (and (fp.isZero wanted_y) (fp.isZero wanted_z)))\n";

const change without_saturation{"length > bound.saturation", "false"};

TEST_F(prove_gate, finds_limits_that_are_ignored) {
  NEEDS_TOOLS();
  const auto out = counter_example(broken({without_certificate, without_saturation}),
                                   from_rest + ordinary_bounds() + along_x, too_long());
  EXPECT_TRUE(is_long(out, found("limit")));
}

// A NaN is neither above the limit nor below it.
TEST_F(prove_gate, finds_a_certificate_that_nan_passes) {
  NEEDS_TOOLS();
  const auto out = counter_example(broken({without_saturation,
                                           {"finite & allowed", "allowed"},
                                           {"measured <= bound.limit", "!(measured > bound.limit"},
                                           {"* 1.00000001;", "* 1.00000001);"}}),
                                   from_rest + ordinary_bounds() + along_x, not_finite);
  EXPECT_TRUE(is_odd(out));
  EXPECT_EQ(out[4], 1.0);
}

// From rest, with limits as a device has them, an infinite wrench makes the usual clamp multiply infinity by zero.
TEST_F(prove_gate, finds_the_usual_clamp_without_a_test_for_nan) {
  NEEDS_TOOLS();
  const auto out =
      counter_example(broken({without_certificate, {"finite & allowed", "allowed"}}),
                      from_rest + ordinary_bounds() + along_x + "(assert (not (fp.isNaN wanted_x)))\n", not_finite);
  EXPECT_TRUE(is_odd(out));
}

TEST_F(prove_gate, finds_a_limit_per_axis) {
  NEEDS_TOOLS();
  const auto per_axis = [](const std::string& a) {
    return change{a + " *= shrink;", a + " = " + a + " > bound.saturation ? bound.saturation : (" + a +
                                         " < -bound.saturation ? -bound.saturation : " + a + ");"};
  };
  const auto out = counter_example(
      broken({per_axis("x"), per_axis("y"), per_axis("z"), {"measured = x * x + y * y + z * z", "measured = x * x"}}),
      from_rest + ordinary_bounds() + "(assert (and allowed (fp.isZero wanted_z)))\n", too_long());
  EXPECT_TRUE(is_long(out, found("limit")));
}

TEST_F(prove_gate, finds_a_stale_command_that_is_obeyed) {
  NEEDS_TOOLS();
  const auto out = counter_example(broken({without_saturation, {"finite & allowed", "finite"}}),
                                   from_rest + ordinary_bounds() + along_x + "(assert (not allowed))\n", leaves);
  EXPECT_TRUE(out[0] != 0.0 || out[1] != 0.0 || out[2] != 0.0);
}

TEST_F(prove_gate, finds_an_axis_that_is_not_tested) {
  NEEDS_TOOLS();
  const auto out = counter_example({{" & (std::fabs(wanted.z) <= largest)", ""}}, "", wrongly_finite());
  EXPECT_EQ(out[3], 1.0);
  EXPECT_FALSE(std::fabs(found("wanted_z")) <= 1e150);
}

// An instruction that nobody wrote down a meaning for stops the proof; it is not passed over.
TEST(prove_gate_translation, refuses_what_it_does_not_understand) {
  const std::string head = "define void @f(double %0, double* %1) local {\n";
  const std::string tail = "  store double %3, double* %1, align 8\n  ret void\n}\n";
  EXPECT_TRUE(to_smt(head + "  %3 = fadd double %0, 1.000000e+00\n" + tail, {"a"}, {"b"}, cut::nothing));
  for (const char* const line :
       {"%3 = fadd fast double %0, 1.0", "%3 = fadd nnan double %0, 1.0", "%3 = frem double %0, 1.0", "br label %9",
        "call void @g()", "%3 = call double @llvm.fma.f64(double %0, double %0, double %0)"}) {
    EXPECT_FALSE(to_smt(head + "  " + line + '\n' + tail, {"a"}, {"b"}, cut::nothing)) << line;
  }
  EXPECT_FALSE(to_smt(head + tail + head + tail, {"a"}, {"b"}, cut::nothing)) << "two functions";
  EXPECT_FALSE(to_smt("", {"a"}, {"b"}, cut::nothing));
}

}  // namespace
