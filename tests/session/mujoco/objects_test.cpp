// Names, frames, masks: what textured_contacts::make() finds in a model, and what it refuses.
#include <set>
#include <utility>

#include "asperity/mujoco/conversions.hpp"
#include "asperity/mujoco/textured_contacts.hpp"
#include "session/mujoco/simulation.hpp"
#include "support/fresh_seed.hpp"

namespace {

using namespace asperity;
using namespace asperity::test_support;
using mujoco::object_kind;
using mujoco::textured_contacts;
using mujoco::textured_pair;
using testing::Test;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

const model_ptr& cube() {
  static const model_ptr made = flat_box(vec3(0.01));
  return made;
}
textured_pair named(const char* probe, const char* fixed, object_kind kind = object_kind::body) {
  return {.probe = {cube(), probe, kind}, .fixed = {cube(), fixed, kind}, .make_renderer = numb()};
}

TEST(mujoco_objects, a_geoms_model_is_where_mujoco_has_the_geom) {
  drawn draw(seed_of(fresh_seed("mujoco_objects.geoms", "20 placements"), "mujoco_geoms"));
  for (int i = 0; i < 20; ++i) {
    const pose T_bg{drawn_rotation(draw), draw.inside(0.1)}, T_gm{drawn_rotation(draw), draw.inside(0.02)};
    const std::string placed = "pos='" + text(T_bg.position) + "' quat='" + text(T_bg.rotation) + "'";
    const simulation s("<worldbody><geom name='wall' type='box' size='.01 .01 .01'" + std::string(ghost) + placed +
                       "/><body name='b'><freejoint/><geom name='g' type='box' size='.01 .01 .01' " + ghost + placed +
                       "/></body></worldbody>");
    textured_pair pair = named("g", "wall", object_kind::geom);
    pair.probe.T_om = T_gm;
    textured_contacts contacts = made(s, {pair});
    mujoco::pose_to_qpos({drawn_rotation(draw), draw.inside(1.0)}, std::span<double, 7>(s.d().qpos, 7));
    mj_step1(&s.m(), &s.d());
    ASSERT_EQ(contacts.apply(s.m(), s.d()), status::ok);
    for (const bool probe : {true, false}) {
      const int geom = s.geom(probe ? "g" : "wall");
      const pose T_wm = probe ? contacts.T_w_probe(0) : contacts.T_w_fixed(0);
      const vec3 p = draw.inside(0.1), p_g = probe ? T_gm * p : p;
      const std::array<double, 3> in{p_g.x, p_g.y, p_g.z};
      std::array<double, 3> out{};
      mju_rotVecMat(out.data(), in.data(), s.d().geom_xmat + 9 * geom);
      mju_addTo3(out.data(), s.d().geom_xpos + 3 * geom);
      EXPECT_LT(glm::length(T_wm * p - vec3(out[0], out[1], out[2])), 1e-12);
    }
  }
}

// A box whose corners are about `centre` in its mesh.
std::string box_mesh(const vec3& centre, const vec3& half) {
  std::string out = "<asset><mesh name='mesh' vertex='";
  for (int c = 0; c < 8; ++c) {
    out += text(centre + half * vec3((c & 1) != 0 ? 1 : -1, (c & 2) != 0 ? 1 : -1, (c & 4) != 0 ? 1 : -1));
  }
  return out + "'/></asset>";
}

model_ptr box_about(const vec3& centre, const vec3& half) {
  textured_model m = make_flat_box(half, 48);
  for (vec3& p : m.mesh.positions) p += centre;
  for (glm::vec3& t : m.texture.texels) t += glm::vec3(centre);
  for (convex_piece& piece : m.pieces) {
    for (vec3& p : piece.vertices) p += centre;
  }
  m.mass = compute_mass_properties(m.mesh);
  m.box = {centre - half, centre + half};
  return std::make_shared<const textured_model>(std::move(m));
}

TEST(mujoco_objects, a_mesh_geoms_model_is_where_the_mesh_is_though_mujoco_moves_its_frame) {
  drawn draw(seed_of(fresh_seed("mujoco_objects.meshes", "12 meshes"), "mujoco_meshes"));
  double furthest_m = 0.0;
  for (int i = 0; i < 12; ++i) {
    const vec3 centre = draw.inside(0.2), half{0.008, 0.01, 0.015};
    const model_ptr model = box_about(centre, half);
    const pose T_bg = i % 2 == 0 ? pose{} : pose{drawn_rotation(draw), draw.inside(0.1)};
    const simulation s(box_mesh(centre, half) + "<worldbody><geom name='wall' type='box' size='.01 .01 .01'" + ghost +
                       "/><body name='b'><freejoint/><geom name='g' type='mesh' mesh='mesh' pos='" +
                       text(T_bg.position) + "' quat='" + text(T_bg.rotation) + "'" + ghost + "/></body></worldbody>");
    textured_pair pair = named("g", "wall", object_kind::geom);
    pair.probe.model = model;
    pair.probe.T_om = T_bg;
    textured_contacts contacts = made(s, {pair});
    mujoco::pose_to_qpos({drawn_rotation(draw), draw.inside(1.0)}, std::span<double, 7>(s.d().qpos, 7));
    mj_step1(&s.m(), &s.d());
    ASSERT_EQ(contacts.apply(s.m(), s.d()), status::ok);
    const int geom = s.geom("g");
    for (int v = 0; v < s.m().mesh_vertnum[0]; ++v) {
      const float* const at = s.m().mesh_vert + 3 * v;
      const std::array<double, 3> in{at[0], at[1], at[2]};
      std::array<double, 3> out{};
      mju_rotVecMat(out.data(), in.data(), s.d().geom_xmat + 9 * geom);
      mju_addTo3(out.data(), s.d().geom_xpos + 3 * geom);
      double nearest_m = 1.0;
      for (const vec3& p : model->mesh.positions) {
        nearest_m = std::min(nearest_m, glm::length(contacts.T_w_probe(0) * p - vec3(out[0], out[1], out[2])));
      }
      EXPECT_LT(nearest_m, 1e-6);  // MuJoCo keeps vertices in float32
      furthest_m =
          std::max(furthest_m,
                   glm::length(mujoco::vector_from_mujoco(std::span<const double, 3>(s.m().geom_pos + 3 * geom, 3))));
    }
    // Without the geom's place, or in millimetres, the model is not where the mesh is.
    if (i % 2 == 1) {
      pair.probe.T_om = {};
      EXPECT_TRUE(has(refusal(s, {pair}), "give the geom's pos and quat of the MJCF as T_om"));
    }
    pair.probe.T_om = T_bg;
    pair.probe.model = box_about(1e3 * centre, 1e3 * half);
    EXPECT_TRUE(has(refusal(s, {pair}), "bake the model in the mesh's units"));
  }
  EXPECT_GT(furthest_m, 0.05);  // MuJoCo did move its frame
}

// Pairs of geoms that MuJoCo makes contacts of, all being in one place.
std::set<std::pair<int, int>> contacts_of(const simulation& s) {
  mj_fwdPosition(&s.m(), &s.d());
  std::set<std::pair<int, int>> out;
  for (int i = 0; i < s.d().ncon; ++i) {
    out.insert(std::minmax(s.d().contact[i].geom1, s.d().contact[i].geom2));
  }
  return out;
}

TEST(mujoco_objects, contacts_of_the_geoms_are_refused_and_switched_off_and_no_others) {
  drawn draw(seed_of(fresh_seed("mujoco_objects.masks", "60 models of 8 geoms"), "mujoco_masks"));
  int refused = 0, allowed = 0;
  for (int i = 0; i < 60; ++i) {
    const auto masks = [&] {
      return " contype='" + std::to_string(draw.bits() % 8) + "' conaffinity='" + std::to_string(draw.bits() % 8) +
             "' ";
    };
    const auto ball = [&](const std::string& name) { return "<geom name='" + name + "' size='.01'" + masks() + "/>"; };
    const bool excluded = i % 10 == 0;
    const std::string xml = std::string("<size njmax='400' nconmax='60'/><option iterations='1' solver='PGS'/>") +
                            (excluded ? "<contact><exclude body1='a' body2='b'/></contact>" : "") + "<worldbody>" +
                            ball("w") + "<body name='a'><freejoint/>" + ball("a1") + ball("a2") +
                            "</body><body name='b' pos='.001 0 0'><freejoint/>" + ball("b1") + ball("b2") + ball("b3") +
                            "</body><body name='c' pos='0 .001 0'><freejoint/>" + ball("c1") + ball("c2") +
                            "</body></worldbody>";
    const simulation s(xml);
    const std::set<std::pair<int, int>> before = contacts_of(s);
    const bool by_body = i % 2 == 0;
    const textured_pair pair = by_body ? named("a", "b") : named("a1", "b2", object_kind::geom);
    const auto between = [&](const std::pair<int, int>& g) {
      if (!by_body) return g == std::pair<int, int>(std::minmax(s.geom("a1"), s.geom("b2")));
      const std::pair<int, int> bodies = std::minmax(s.m().geom_bodyid[g.first], s.m().geom_bodyid[g.second]);
      return bodies == std::pair<int, int>(std::minmax(s.body("a"), s.body("b")));
    };
    std::set<std::pair<int, int>> wanted;
    for (const auto& g : before) {
      if (!between(g)) wanted.insert(g);
    }
    const std::string why = refusal(s, {pair});
    EXPECT_EQ(why.empty(), wanted == before) << why;
    (why.empty() ? allowed : refused) += 1;
    EXPECT_EQ(why.empty(), !has(why, "switch_off_own_contacts()")) << why;
    ASSERT_TRUE(mujoco::switch_off_own_contacts(s.m(), std::span(&pair, 1)));
    EXPECT_EQ(contacts_of(s), wanted);
    EXPECT_EQ(refusal(s, {pair}), "");
  }
  EXPECT_GT(refused, 10);
  EXPECT_GT(allowed, 5);
}

TEST(mujoco_objects, contacts_that_masks_do_not_rule_stay_refused) {
  const std::string bodies =
      "<worldbody><body name='a'><freejoint/><geom name='a' size='.01'/></body><body name='b'><freejoint/><geom "
      "name='b' "
      "size='.01'/></body></worldbody>";
  const textured_pair pair = named("a", "b");
  const simulation paired("<contact><pair geom1='a' geom2='b'/></contact>" + bodies);
  EXPECT_TRUE(has(refusal(paired, {pair}), "makes contacts between geom 'a' and geom 'b'"));
  const result<void> paired_off = mujoco::switch_off_own_contacts(paired.m(), std::span(&pair, 1));
  ASSERT_FALSE(paired_off);
  EXPECT_EQ(paired_off.error().code, error_code::unsupported);
  EXPECT_TRUE(has(paired_off.error().message, "<pair> element"));
  const simulation full("<worldbody><geom name='all' size='.01' contype='2147483647'/></worldbody>" + bodies);
  const result<void> no_bit = mujoco::switch_off_own_contacts(full.m(), std::span(&pair, 1));
  ASSERT_FALSE(no_bit);
  EXPECT_EQ(no_bit.error().code, error_code::limit_exceeded);
  EXPECT_EQ(full.m().geom_contype[full.geom("a")], 1);  // nothing was changed
}

TEST(mujoco_objects, what_cannot_be_is_refused_with_the_mend) {
  const simulation s(
      "<worldbody><geom name='floor' type='plane' size='1 1 1' contype='0' conaffinity='0'/>"
      "<body name='post'><geom name='top' size='.01' contype='0' conaffinity='0'/></body>"
      "<body name='a'><freejoint/><geom name='ga' size='.01' contype='0' conaffinity='0'/>"
      "<body name='welded'><geom size='.01' contype='0' conaffinity='0'/></body></body>"
      "<body name='b'><freejoint/><geom size='.01' contype='0' conaffinity='0'/></body></worldbody>");
  EXPECT_EQ(refusal(s, {named("a", "b")}), "");
  EXPECT_TRUE(has(refusal(s, {}), "there is no MuJoCo pair"));
  EXPECT_TRUE(has(refusal(s, {named("nobody", "b")}),
                  "pair 0, probe: the MuJoCo model has no body 'nobody'; it has: world, post, a, welded, b"));
  EXPECT_TRUE(has(refusal(s, {named("a", "b"), named("a", "")}), "pair 1, fixed: the MuJoCo model has no body ''"));
  EXPECT_TRUE(
      has(refusal(s, {named("a", "top")}), "'top' is the name of a geom and not of a body: set object_kind::geom"));
  EXPECT_TRUE(has(refusal(s, {named("a", "top", object_kind::geom)}),
                  "'a' is the name of a body and not of a geom: set object_kind::body"));
  EXPECT_TRUE(has(refusal(s, {named("post", "world")}), "body 'post' and body 'world' cannot move against each other"));
  EXPECT_TRUE(has(refusal(s, {named("a", "welded")}), "cannot move against each other: one of them needs a joint"));
  EXPECT_TRUE(has(refusal(s, {named("a", "a")}), "cannot move against each other"));
  textured_pair pair = named("a", "b");
  pair.probe.model = nullptr;
  EXPECT_TRUE(has(refusal(s, {pair}), "there is no textured model"));
  textured_model hollow = *cube();
  hollow.mass = {};
  pair.probe.model = std::make_shared<const textured_model>(hollow);
  EXPECT_TRUE(has(refusal(s, {pair}), "encloses no volume"));
  pair = named("a", "b");
  pair.fixed.T_om.rotation = quat(1.0, 1.0, 0.0, 0.0);
  EXPECT_TRUE(has(refusal(s, {pair}), "fixed: T_om is no pose"));
  pair = named("a", "b");
  pair.damping_s = -1.0;
  EXPECT_TRUE(has(refusal(s, {pair}), "damping_s has to be a finite time, 0 or more"));
  pair.damping_s = std::nan("");
  EXPECT_TRUE(has(refusal(s, {pair}), "damping_s"));
  pair = named("a", "b");
  pair.make_renderer = nullptr;
  pair.stiffness_n_per_m = 0.0;
  EXPECT_TRUE(has(refusal(s, {pair}), "MuJoCo pair 0: least motion: stiffness_n_per_m"));
  pair = named("a", "b");
  pair.make_renderer = [](scene) -> result<any_renderer> { return error{error_code::bad_mesh, "no"}; };
  EXPECT_EQ(refusal(s, {pair}), "MuJoCo pair 0: no");
  for (const mujoco::step_bound& bound :
       {mujoco::step_bound{0.0, 0.5}, {1.1, 0.5}, {1.0, 0.0}, {1.0, 0.6}, {std::nan(""), 0.5}}) {
    EXPECT_TRUE(has(refusal(s, {named("a", "b")}, bound), "the step bound's stiffness has to be"));
  }
  s.m().body_subtreemass[s.body("a")] = 0.0;
  EXPECT_TRUE(has(refusal(s, {named("a", "b")}), "body 'a' moves and has no mass"));
}

}  // namespace
