// The document of query: what each formulation tells of a touch, and which options contradict each other.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "documents.hpp"

namespace fault {
namespace {

class query_document : public documents, public testing::WithParamInterface<const char*> {};

TEST_P(query_document, is_the_contract) {
  // Ridges in grooves, and the upper block two tenths of a millimetre too low.
  const json d = expect_document(
      {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 0.0198 0 0 0 1", "--contacts", GetParam()},
      "asperity.query/1");
  expect_keys(d, {"schema", "contacts", "force", "torque", "centre_of_mass", "stiffness", "formulation", "backend",
                  "bodies", "gradient_scheme", "lookup", "status", "dropped_contacts", "units"});
  EXPECT_EQ(d["formulation"], GetParam());
  EXPECT_EQ(d["gradient_scheme"], std::string(GetParam()) == "least-motion" ? "exact" : "soft");
  EXPECT_EQ(d["backend"], "cpu");
  EXPECT_EQ(d["units"], "SI");
  expect_numbers(d["force"], 3);
  expect_numbers(d["torque"], 3);
  expect_numbers(d["centre_of_mass"], 3);
  expect_numbers(d["stiffness"], 36);
  ASSERT_EQ(d["bodies"].size(), 1U);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(d["bodies"][0]["force"][i], -d["force"][i].get<double>());
  expect_numbers(d["bodies"][0]["torque"], 3);
  ASSERT_FALSE(d["contacts"].empty());
  std::array<double, 3> felt{};
  for (const json& c : d["contacts"]) {
    expect_keys(c, {"body", "p_a", "p_b", "n_ab", "centre", "u", "half_size", "separation", "depth", "soft_depth",
                    "gradient", "witness", "samples", "flags", "force", "torque"});
    for (const char* key : {"p_a", "p_b", "n_ab", "centre", "u", "witness", "force", "torque"}) {
      expect_numbers(c[key], 3);
    }
    for (std::size_t i = 0; i < 3; ++i) felt[i] += c["force"][i].get<double>();
    expect_numbers(c["gradient"], 6);
    EXPECT_EQ(c["body"], 0);
    EXPECT_TRUE(c["flags"].is_array());
    EXPECT_TRUE(c["samples"].is_number_unsigned());
    // The gradient's component along n is 1 exactly.
    double along = 0.0;
    for (std::size_t i = 0; i < 3; ++i) along += c["gradient"][i].get<double>() * c["n_ab"][i].get<double>();
    EXPECT_NEAR(along, 1.0, 1e-9);
  }
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(felt[i], d["force"][i], 1e-9);
  // From the probe above to the body below. The least motion leans towards a flank of the ridges, by 0.17 rad with this
  // small texture.
  EXPECT_NEAR(d["contacts"][0]["n_ab"][2], -1.0, std::string(GetParam()) == "least-motion" ? 0.03 : 1e-6);
  EXPECT_GT(d["contacts"][0]["depth"], 2e-4 - 1e-6);
  EXPECT_LT(d["contacts"][0]["depth"], 1e-3);  // the small texture is coarse beside the ridges
  EXPECT_GT(d["force"][2], 0.0);               // and the probe is pushed up
}

INSTANTIATE_TEST_SUITE_P(both, query_document, testing::Values("least-motion", "window"), [](const auto& formulation) {
  return std::string(formulation.param) == "window" ? "window" : "least_motion";
});

TEST_F(documents, what_belongs_to_the_paper_is_refused_without_it) {
  for (const arguments& option :
       {arguments{"--gradient", "central"}, arguments{"--grid", "32"}, arguments{"--lookup", "paper"}}) {
    arguments query{"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1"};
    query.insert(query.end(), option.begin(), option.end());
    const std::string message = expect_failure(query, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front()), std::string::npos);
    EXPECT_NE(message.find("--contacts window"), std::string::npos);
    query.insert(query.end(), {"--contacts", "window"});
    EXPECT_EQ(expect_document(query, "asperity.query/1")["formulation"], "window");
  }
}

TEST_F(documents, former_names_of_contacts_are_accepted) {
  arguments query{"query", "--probe", pin(), "--fixed", pin(), "--probe-pose", "0 0 1 0 0 0 1", "--contacts"};
  for (const auto& [former, name] : {std::pair{"shared", "least-motion"}, std::pair{"paper", "window"}}) {
    query.push_back(former);
    EXPECT_EQ(expect_document(query, "asperity.query/1")["formulation"], name) << former;
    query.pop_back();
  }
  const arguments session{"run", "--probe", pin(), "--fixed", pin(), "--seconds", "0.01", "--contacts", "field"};
  EXPECT_EQ(expect_document(session, "asperity.run/1")["formulation"], "planes");
}

TEST_F(documents, query_far_away_has_no_contact_and_no_force) {
  const json d = expect_document({"query", "--probe", pin(), "--fixed", pin(), "--probe-pose", "0 0 1 0 0 0 1"},
                                 "asperity.query/1");
  EXPECT_EQ(d["contacts"], json::array());
  EXPECT_EQ(d["force"], json::array({0.0, 0.0, 0.0}));
  EXPECT_EQ(d["torque"], json::array({0.0, 0.0, 0.0}));
}

TEST_F(documents, both_gradient_schemes_agree_on_the_depth) {
  const arguments query{
      "query",      "--probe", block(), "--fixed", block(), "--probe-pose", "0.001 0.0005 0.0198 0 0 0 1",
      "--contacts", "window"};
  arguments central = query;
  central.insert(central.end(), {"--gradient", "central"});
  const json soft = expect_document(query, "asperity.query/1");
  const json paper = expect_document(central, "asperity.query/1");
  ASSERT_FALSE(soft["contacts"].empty());
  ASSERT_EQ(paper["contacts"].size(), soft["contacts"].size());
  EXPECT_EQ(paper["contacts"][0]["depth"], soft["contacts"][0]["depth"]);
  EXPECT_EQ(paper["contacts"][0]["soft_depth"], paper["contacts"][0]["depth"]);
}

TEST_F(documents, the_exact_maximum_is_deeper_than_a_grid_s_and_says_how_deep_it_can_be) {
  const arguments query{"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0.001 0.0005 0.0198 0 0 0 1"};
  arguments paper = query, exact = query;
  paper.insert(paper.end(), {"--contacts", "window"});
  exact.insert(exact.end(), {"--backend", "exact"});
  const json on_grid = expect_document(paper, "asperity.query/1");
  const json searched = expect_document(exact, "asperity.query/1");
  EXPECT_EQ(searched["backend"], "exact");
  EXPECT_EQ(searched["formulation"], "window");
  EXPECT_EQ(searched["gradient_scheme"], "exact");
  ASSERT_FALSE(searched["contacts"].empty());
  ASSERT_EQ(searched["contacts"].size(), on_grid["contacts"].size());
  for (std::size_t i = 0; i < searched["contacts"].size(); ++i) {
    const json &c = searched["contacts"][i], &g = on_grid["contacts"][i];
    EXPECT_EQ(c["centre"], g["centre"]) << "the same window";
    EXPECT_FALSE(g.contains("depth_at_most"));
    const double depth = c["depth"], most = c["depth_at_most"];
    EXPECT_GE(most, depth);
    EXPECT_LE(most, depth + 1e-8);
    EXPECT_GT(depth, g["depth"].get<double>()) << "samples reach the maximum from below";
    EXPECT_EQ(c["flags"], g["flags"]);
  }
}

TEST_F(documents, what_contradicts_the_exact_maximum_is_refused_by_name) {
  for (const arguments& option :
       {arguments{"--contacts", "least-motion"}, arguments{"--gradient", "soft"}, arguments{"--grid", "64"}}) {
    arguments query{"query",        "--probe",       block(),     "--fixed", block(),
                    "--probe-pose", "0 0 1 0 0 0 1", "--backend", "exact"};
    query.insert(query.end(), option.begin(), option.end());
    const std::string message = expect_failure(query, 1, "invalid_argument");
    EXPECT_NE(message.find(option.front()), std::string::npos) << message;
    EXPECT_NE(message.find("--backend exact"), std::string::npos) << message;
  }
  EXPECT_NE(expect_failure({"run", "--probe", block(), "--fixed", block(), "--backend", "exact", "--clock", "real"}, 1,
                           "invalid_argument")
                .find("--clock virtual"),
            std::string::npos);
  EXPECT_EQ(expect_document({"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1",
                             "--backend", "exact", "--contacts", "window"},
                            "asperity.query/1")["contacts"],
            json::array());
}

TEST_F(documents, backends_that_are_not_built_say_so) {
#ifdef ASPERITY_HAS_GL
  const std::vector<const char*> missing{"cpu-simd"};
#else
  const std::vector<const char*> missing{"cpu-simd", "gl-occlusion", "gl-compute"};
#endif
  for (const char* backend : missing) {
    const std::string message = expect_failure(
        {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1", "--backend", backend}, 1,
        "unsupported");
    EXPECT_NE(message.find(backend), std::string::npos);
  }
  expect_failure(
      {"query", "--probe", block(), "--fixed", block(), "--probe-pose", "0 0 1 0 0 0 1", "--backend", "abacus"}, 2,
      "usage");
}

}  // namespace
}  // namespace fault
