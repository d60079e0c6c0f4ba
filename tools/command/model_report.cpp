#include "model_report.hpp"

#include <algorithm>

#include "asperity/field/field_body.hpp"
#include "material_option.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

double percent_of_diagonal(const textured_model& model, double metres) {
  const double diagonal = model.box.diagonal();
  return diagonal > 0.0 ? 100.0 * metres / diagonal : 0.0;
}

std::size_t flat_pieces(const textured_model& model) {
  return static_cast<std::size_t>(
      std::count_if(model.pieces.begin(), model.pieces.end(), [](const convex_piece& p) { return p.flat; }));
}

double share(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string error_text(const textured_model& model, double metres) {
  return length_text(metres) + "  (" + brief(percent_of_diagonal(model, metres)) + " % of the diagonal)";
}

json spread_json(const length_spread& s) { return {{"p50", s.median_m}, {"p99", s.p99_m}, {"max", s.max_m}}; }

json error_json(const length_spread& s, double rms_m) {
  json out = spread_json(s);
  out["rms"] = rms_m;
  return out;
}

void add_quality(const bake_quality& q, json& to) {
  json& bake = to["bake"];
  bake["to_original"] = error_json(q.to_original, q.to_original_rms_m);
  bake["to_textured"] = error_json(q.to_textured, q.to_textured_rms_m);
  bake["crack"] = q.crack_max_m;
  bake["lost"] = {{"share", q.lost_share},
                  {"largest_share", q.lost_part_share},
                  {"centre", to_json(q.lost_part_centre)},
                  {"low", to_json(q.lost_part_low)},
                  {"high", to_json(q.lost_part_high)}};
  to["texture"]["texel"] = q.texel_m;
  to["texture"]["utilisation"] = q.atlas_utilisation;
  to["texture"]["spacing"] = spread_json(q.texel_spacing);
  to["pieces"]["surface_to_hull"] = q.surface_to_hull_max_m;
  to["pieces"]["bridged_air"] = q.bridged_air_max_m;
}

// "half within 1.2 um, 99 % within 20 um, all within 0.1 mm (0.05 % of the diagonal)"
std::string spread_text(const textured_model& model, const length_spread& s) {
  return "half within " + length_text(s.median_m) + ", 99 % within " + length_text(s.p99_m) + ", all within " +
         error_text(model, s.max_m);
}

std::string quality_text(const textured_model& model, const bake_quality& q) {
  std::string out;
  out += row("texture to mesh", spread_text(model, q.to_original));
  out += row("mesh to texture", spread_text(model, q.to_textured));
  out += row("widest crack", error_text(model, q.crack_max_m));
  std::string lost = brief(100.0 * q.lost_share) + " % of the area";
  if (q.lost_share > 0.0) {
    const vec3& c = q.lost_part_centre;
    lost += "; the largest part, " + brief(100.0 * q.lost_part_share) + " %, about " + length_text(c.x) + ", " +
            length_text(c.y) + ", " + length_text(c.z);
  }
  out += row("lost", lost);
  out += row("texels", length_text(q.texel_m) + " on the coarse mesh; on the surface " +
                           length_text(q.texel_spacing.median_m) + " median, " + length_text(q.texel_spacing.p99_m) +
                           " p99, " + length_text(q.texel_spacing.max_m) + " at most");
  out += row("hulls", "surface up to " + error_text(model, q.surface_to_hull_max_m) + " deep in them, air up to " +
                          error_text(model, q.bridged_air_max_m) + " bridged");
  return out;
}

json to_json(const field_body& body) {
  return {{"memory", memory_bytes(body)},
          {"pitch", body.field.smooth.pitch_m},
          {"relief_pitch", body.field.fine.pitch_m},
          {"thickness", body.field.thickness_m > 0.0 ? json(body.field.thickness_m) : json()},
          {"samples", body.samples.samples().size()},
          {"plain_samples", body.plain.samples().size()}};
}

// "16 MB, smooth part every 1.2 mm, relief every 0.2 mm, 119827 samples and 13000 on plain faces; thinnest parts 2.1 mm"
std::string to_text(const field_body& body) {
  std::string out = memory_text(memory_bytes(body)) + ", smooth part every " + length_text(body.field.smooth.pitch_m) +
                    ", relief every " + length_text(body.field.fine.pitch_m) + ", " +
                    std::to_string(body.samples.samples().size()) + " samples";
  if (!body.plain.samples().empty()) {
    out += " and " + std::to_string(body.plain.samples().size()) + " on plain faces";
  }
  if (body.field.thickness_m > 0.0) out += "; thinnest parts " + length_text(body.field.thickness_m);
  return out;
}

}  // namespace

json describe(const textured_model& model) {
  const bake_report& r = model.report;
  const mat3& inertia = model.mass.inertia_per_mass;
  const std::size_t image = std::size_t{model.texture.width} * model.texture.height;
  json inertia_rows = json::array();
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) inertia_rows.push_back(inertia[j][i]);
  }
  json out = {
      {"name", model.name},
      {"full_triangles", r.full_triangles},
      {"coarse", {{"vertices", model.mesh.positions.size()}, {"triangles", model.mesh.triangles.size()}}},
      {"pieces", {{"count", model.pieces.size()}, {"flat", flat_pieces(model)}}},
      {"texture",
       {{"width", model.texture.width},
        {"height", model.texture.height},
        {"texels", r.texels},
        {"coverage", share(r.texels, image)},
        {"fallback_texels", r.fallback_texels},
        {"fallback_share", share(r.fallback_texels, r.texels)}}},
      {"size",
       {{"low", to_json(model.box.low)}, {"high", to_json(model.box.high)}, {"diagonal", model.box.diagonal()}}},
      {"mass_properties",
       {{"volume", model.mass.volume_m3},
        {"centre_of_mass", to_json(model.mass.centre_of_mass)},
        {"inertia_per_mass", inertia_rows}}},
      {"bake",
       {{"rms_error", r.rms_error_m},
        {"max_error", r.max_error_m},
        {"rms_error_percent", percent_of_diagonal(model, r.rms_error_m)},
        {"max_error_percent", percent_of_diagonal(model, r.max_error_m)},
        {"peak_to_valley", r.peak_to_valley_m},
        {"max_displacement", r.max_displacement_m}}},
      {"material", model.surface ? to_json(*model.surface) : json()},
      {"materials", materials_json(model)},
      {"field", model.field ? to_json(*model.field) : json()},
      {"memory", memory_bytes(model)},
  };
  if (r.quality) add_quality(*r.quality, out);
  return out;
}

std::string describe_text(const textured_model& model) {
  const bake_report& r = model.report;
  const vec3 size = model.box.high - model.box.low;
  const std::size_t image = std::size_t{model.texture.width} * model.texture.height;
  std::string out;
  out += row("name", model.name);
  out += row("size", length_text(size.x) + " x " + length_text(size.y) + " x " + length_text(size.z) + ", diagonal " +
                         length_text(model.box.diagonal()));
  out += row("full mesh", std::to_string(r.full_triangles) + " triangles");
  out += row("coarse mesh", std::to_string(model.mesh.triangles.size()) + " triangles, " +
                                std::to_string(model.mesh.positions.size()) + " vertices");
  out +=
      row("convex pieces", std::to_string(model.pieces.size()) + ", " + std::to_string(flat_pieces(model)) + " flat");
  out += row("haptic texture", std::to_string(model.texture.width) + " x " + std::to_string(model.texture.height) +
                                   " texels, " + brief(100.0 * share(r.texels, image)) + " % used, " +
                                   brief(100.0 * share(r.fallback_texels, r.texels)) +
                                   " % of these found by the closest point");
  out += row("relief", length_text(r.peak_to_valley_m) + " peak to valley, at most " +
                           length_text(r.max_displacement_m) + " from the coarse mesh");
  out += row("RMS error", error_text(model, r.rms_error_m));
  out += row("maximum error", error_text(model, r.max_error_m));
  if (r.quality) out += quality_text(model, *r.quality);
  out += row("volume", brief(model.mass.volume_m3 * 1e6) + " cm^3");
  const vec3& c = model.mass.centre_of_mass;
  out += row("centre of mass", length_text(c.x) + ", " + length_text(c.y) + ", " + length_text(c.z));
  if (model.surface && model.surface_map.empty()) out += row("material", to_text(*model.surface));
  if (!model.surface_map.empty()) {
    const std::vector<double> shares = material_shares(model);
    for (std::size_t i = 0; i < shares.size(); ++i) {
      out += row("material " + std::to_string(i),
                 brief(100.0 * shares[i]) + " % of the surface, " + to_text(*material_of(model, i)));
    }
  }
  out += row("depth field", model.field ? to_text(*model.field) : "none kept; every load makes it");
  out += row("memory", memory_text(memory_bytes(model)));
  return out;
}

std::vector<std::string> warnings(const textured_model& model) {
  const double diagonal = model.box.diagonal();
  std::vector<std::string> out;
  if (!is_sensible_size(diagonal)) {
    out.push_back("the diagonal is " + length_text(diagonal) + ", outside " + sensible_sizes() +
                  ": if the source is not in metres, bake it again with --units or --scale");
  }
  if (model.report.max_error_m > 0.01 * diagonal) {
    out.push_back("the textured surface misses the original by up to " + length_text(model.report.max_error_m) +
                  ", more than 1 % of the diagonal: bake with more --triangles");
  }
  const double fallback = share(model.report.fallback_texels, model.report.texels);
  if (fallback > 0.05) {
    out.push_back(brief(100.0 * fallback) +
                  " % of the texels found the surface only by its closest point: bake with more --triangles");
  }
  if (model.report.quality) {
    const bake_quality& q = *model.report.quality;
    if (q.lost_share > 0.01) {
      out.push_back(brief(100.0 * q.lost_share) + " % of the original's area is not in the texture, most of it about " +
                    length_text(q.lost_part_centre.x) + ", " + length_text(q.lost_part_centre.y) + ", " +
                    length_text(q.lost_part_centre.z) +
                    ": it cannot be felt; if it should be, bake with more --triangles or give a --coarse mesh");
    }
    if (q.surface_to_hull_max_m > 0.001 * diagonal || q.bridged_air_max_m > 0.005 * diagonal) {
      out.push_back("the convex pieces are off the coarse mesh by up to " +
                    length_text(std::max(q.surface_to_hull_max_m, q.bridged_air_max_m)) +
                    ": contacts may be found there too early; ask for more --pieces");
    }
  }
  return out;
}

std::string warnings_text(const std::vector<std::string>& warnings) {
  std::string out;
  for (const std::string& w : warnings) out += "  warning: " + printable(w) + '\n';
  return out;
}

}  // namespace asperity::command
