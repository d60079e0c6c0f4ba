#include "bake_document.hpp"

#include <utility>

#include "model_report.hpp"
#include "text.hpp"

namespace asperity::command {

namespace {

json repair_document(const bake::repair_report& repaired) {
  json actions = json::array();
  for (std::size_t k = 0; k < bake::repair_kinds; ++k) {
    const bake::repair_action& a = repaired.actions[k];
    if (a.count == 0) continue;
    actions.push_back({{"action", bake::to_string(static_cast<bake::repair_kind>(k))},
                       {"count", a.count},
                       {"first", {a.first.x, a.first.y, a.first.z}},
                       {"largest_change", a.largest_m}});
  }
  const bake::repair_action& holes = repaired[bake::repair_kind::hole];
  return {{"actions", std::move(actions)},
          {"triangles_before", repaired.triangles_before},
          {"triangles_after", repaired.triangles_after},
          {"made_up_share", repaired.made_up_share},
          {"holes_closed", holes.count},
          {"holes_smooth", repaired.smooth_holes},
          {"triangles_added", repaired.triangles_added},
          {"area_added", repaired.area_added_m2},
          {"largest_hole", holes.largest_m}};
}

std::string repair_text(const bake::repair_report& repaired) {
  std::string out;
  for (std::size_t k = 0; k < bake::repair_kinds; ++k) {
    const auto kind = static_cast<bake::repair_kind>(k);
    const bake::repair_action& a = repaired.actions[k];
    if (a.count == 0) continue;
    if (kind == bake::repair_kind::hole) {
      out += row("holes closed",
                 std::to_string(a.count) +
                     (repaired.smooth_holes > 0 ? " (" + std::to_string(repaired.smooth_holes) + " smoothly)" : "") +
                     ", the largest " + length_text(a.largest_m) + " across; " + brief(100.0 * repaired.made_up_share) +
                     " % of the surface is made up");
      continue;
    }
    std::string told = std::to_string(a.count) + ' ' + bake::in_words(kind, a.count) + ", the first at (" +
                       brief(a.first.x) + ", " + brief(a.first.y) + ", " + brief(a.first.z) + ") m";
    if (a.largest_m > 0.0) told += "; up to " + length_text(a.largest_m);
    out += row("repaired", told);
  }
  return out;
}

}  // namespace

answer report_bake(const finished_bake& done, std::vector<std::string> notes) {
  for (std::string& warning : warnings(done.model)) notes.push_back(std::move(warning));
  answer out;
  out.document = {{"file", done.file}, {"source", done.source}, {"scale", done.scale}};
  out.document.update(describe(done.model));
  out.document["repair"] = repair_document(done.repaired);
  out.document["uvs"] = done.kept_uvs ? "kept" : "made";
  if (done.relief.relief) out.document["relief"] = done.relief.document;
  json stages = json::array();
  std::string times;
  double total = 0.0;
  for (const auto& [stage, seconds] : done.clock.stages()) {
    stages.push_back({{"stage", stage}, {"seconds", seconds}});
    times += (times.empty() ? "" : ", ") + stage + ' ' + time_text(seconds);
    total += seconds;
  }
  out.document["stages"] = std::move(stages);
  out.document["seconds"] = total;
  out.document["warnings"] = notes;
  out.document["units"] = "SI";
  out.text = printable(done.source + " -> " + done.file) + '\n' + describe_text(done.model);
  out.text += done.relief.text;
  out.text += repair_text(done.repaired);
  out.text += row("time", time_text(total) + "  (" + times + ')') + warnings_text(notes);
  return out;
}

}  // namespace asperity::command
