#include "relief_options.hpp"

#include <cmath>
#include <utility>

#include "asperity/bake/map_relief.hpp"
#include "asperity/bake/procedural.hpp"
#include "asperity/io/image_file.hpp"
#include "asperity/io/material_file.hpp"
#include "interrupt.hpp"
#include "options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

json image_json(const std::string& file, const map_image& image) {
  return {{"file", file},
          {"width", image.width},
          {"height", image.height},
          {"channels", image.channels},
          {"bits", image.bits == 0 ? json("float") : json(image.bits)}};
}

std::string image_text(const map_image& image) {
  return std::to_string(image.width) + " x " + std::to_string(image.height) + ", " +
         (image.bits == 0 ? std::string("floating point") : std::to_string(image.bits) + " bits");
}

result<relief_job> from_height_map(const relief_options& options, const triangle_mesh& mesh) {
  result<map_image> image = io::load_image(options.height_map, not_interrupted);
  if (!image) return image.error();
  bake::height_map_settings settings;
  settings.keep_going = not_interrupted;
  if (image->bits == 0) {
    if (options.has_range)
      return error{error_code::invalid_argument, options.height_map +
                                                     " holds floating-point heights, which have no black and white: "
                                                     "give --height-scale, metres per unit, instead of --height-range"};
    settings.scale_m = options.height_scale_m;
  } else {
    if (!options.has_range)
      return error{error_code::invalid_argument, options.height_map +
                                                     " holds whole numbers: say with --height-range "
                                                     "LOW,HIGH how high black and white are, m"};
    settings.offset_m = options.height_range_m[0];
    settings.scale_m = options.height_range_m[1] - options.height_range_m[0];
  }
  const json about = image_json(options.height_map, *image);
  const std::uint32_t bits = image->bits;
  const std::string words = image_text(*image);
  auto made = bake::height_map_relief(mesh, std::move(*image), settings);
  if (!made) return error{made.error().code, options.height_map + ": " + made.error().message};
  relief_job job;
  const double step_m = bits == 0 ? 0.0 : std::fabs(settings.scale_m) / ((1U << bits) - 1.0);
  job.document = {{"image", about}, {"texel", made->finest_m}, {"step", step_m}};
  job.text = row("height map", words + ", texels of " + length_text(made->finest_m) +
                                   (step_m > 0.0 ? ", steps of " + length_text(step_m) : std::string()));
  constexpr double finest_step_felt_m = 1e-6;
  if (step_m > finest_step_felt_m && bits <= 8)
    job.notes.push_back("the height map rises in steps of " + length_text(step_m) +
                        ", which can be felt: export it with 16 bits or as floating-point numbers");
  job.relief = std::move(made).value();
  return job;
}

result<relief_job> from_normal_map(const map_image& image, const std::string& name,
                                   const bake::normal_map_settings& settings, const triangle_mesh& mesh) {
  auto made = bake::integrate_normal_map(mesh, image, settings);
  if (!made) return error{made.error().code, name + ": " + made.error().message};
  const bake::normal_map_fit& fit = made->fit;
  relief_job job;
  job.document = {{"image", image_json(name, image)},
                  {"texel", fit.texel_m},
                  {"step", fit.step_m},
                  {"slope_rms", fit.slope_rms},
                  {"residual_rms", fit.residual_rms},
                  {"residual_percent", 100.0 * fit.residual_share()},
                  {"points", fit.points},
                  {"iterations", fit.iterations},
                  {"unmapped_area", fit.unmapped_area}};
  job.text = row("normal map", image_text(image) + ", texels of " + length_text(fit.texel_m)) +
             row("slopes", brief(fit.slope_rms) + " RMS, of it no height has " + brief(fit.residual_rms) + " (" +
                               brief(100.0 * fit.residual_share()) + " %)");
  constexpr double much_residual = 0.3;
  if (fit.residual_share() > much_residual)
    job.notes.push_back("no height has " + brief(100.0 * fit.residual_share()) +
                        " % of the normal map's slopes: try --normal-y " + (settings.green_is_down ? "up" : "down") +
                        ", or the map is not one of slopes alone");
  if (fit.unmapped_area > 0.001)
    job.notes.push_back(brief(100.0 * fit.unmapped_area) +
                        " % of the surface has no area in the map and was taken as flat");
  job.relief = std::move(made->heights);
  return job;
}

result<relief_job> from_normal_file(const relief_options& options, const triangle_mesh& mesh) {
  const result<map_image> image = io::load_image(options.normal_map, not_interrupted);
  if (!image) return image.error();
  bake::normal_map_settings settings;
  settings.keep_going = not_interrupted;
  settings.scale = options.normal_scale;
  settings.green_is_down = options.normal_y == "down";
  return from_normal_map(*image, options.normal_map, settings, mesh);
}

result<relief_job> from_material(const relief_options& options, const triangle_mesh& mesh, const std::string& file) {
  if (const std::string wrong = extension_error(file, {".gltf", ".glb"}); !wrong.empty())
    return error{error_code::invalid_argument, "--from-material needs a glTF asset: " + wrong};
  const result<io::normal_texture> texture = io::load_normal_texture(file, not_interrupted);
  if (!texture) return texture.error();
  bake::normal_map_settings settings;
  settings.keep_going = not_interrupted;
  settings.scale = texture->scale * options.normal_scale;
  settings.green_is_down = options.normal_y == "down";
  settings.wrap_u = texture->wrap_u;
  settings.wrap_v = texture->wrap_v;
  return from_normal_map(texture->image, file, settings, mesh);
}

result<relief_job> by_formula(const relief_options& o, const triangle_mesh& mesh) {
  relief_job job;
  result<bake::relief> made = error{error_code::invalid_argument, "unknown procedural relief"};
  if (o.procedural == "stripes") {
    made = bake::make_stripes({o.pitch_m, o.height_m, {o.direction[0], o.direction[1], o.direction[2]}});
    job.document = {{"pitch", o.pitch_m}, {"height", o.height_m}, {"direction", o.direction}};
  } else if (o.procedural == "dots") {
    const double diameter_m = o.diameter_m > 0.0 ? o.diameter_m : 0.6 * o.pitch_m;
    made = bake::make_dots({o.pitch_m, o.height_m, diameter_m, o.seed}, mesh);
    job.document = {{"pitch", o.pitch_m}, {"height", o.height_m}, {"diameter", diameter_m}, {"seed", o.seed}};
  } else {
    made = bake::make_roughness({o.rms_m, o.spectral_slope, o.wavelengths_m[0], o.wavelengths_m[1], o.seed}, mesh);
    job.document = {
        {"rms", o.rms_m}, {"spectral_slope", o.spectral_slope}, {"wavelengths", o.wavelengths_m}, {"seed", o.seed}};
  }
  if (!made) return made.error();
  job.text = row("procedural relief", o.procedural);
  job.relief = std::move(made).value();
  return job;
}

}  // namespace

std::string relief_options::kind() const {
  return from_material         ? "material"
         : !height_map.empty() ? "height map"
         : !normal_map.empty() ? "normal map"
                               : procedural;
}

void add_relief_options(CLI::App& sub, const std::shared_ptr<relief_options>& o) {
  auto* height = sub.add_option("--height-map", o->height_map,
                                "Add the heights of this image (.png, .tif, .exr, .jpg), laid on by the mesh's UVs");
  auto* range = sub.add_option_function<std::array<double, 2>>(
      "--height-range",
      [o](const std::array<double, 2>& values) {
        o->height_range_m = values;
        o->has_range = true;
      },
      "Heights of black and white of an image of whole numbers, m");
  range->delimiter(',')->type_name("LOW,HIGH")->needs(height);
  sub.add_option("--height-scale", o->height_scale_m, "Metres per unit of an image of floating-point numbers")
      ->needs(height)
      ->excludes(range)
      ->check(positive_number_error, "NUMBER > 0")
      ->capture_default_str();
  auto* normal = sub.add_option("--normal-map", o->normal_map,
                                "Add the relief whose slopes are those of this tangent-space normal map")
                     ->excludes(height);
  auto* material = sub.add_flag("--from-material", o->from_material,
                                "Add the relief of the normal texture in the glTF asset's material")
                       ->excludes(height)
                       ->excludes(normal);
  sub.add_option("--normal-y", o->normal_y, "Where green points in a normal map: up (OpenGL, glTF) or down (DirectX)")
      ->check(CLI::IsMember({"up", "down"}))
      ->capture_default_str();
  sub.add_option("--normal-scale", o->normal_scale, "Factor on the slopes of a normal map")->capture_default_str();
  auto* procedural = sub.add_option("--procedural", o->procedural, "Add a relief by formula")
                         ->check(CLI::IsMember({"stripes", "dots", "noise"}))
                         ->excludes(height)
                         ->excludes(normal)
                         ->excludes(material);
  const auto positive = [&](const char* name, double& value, const char* what) {
    sub.add_option(name, value, what)
        ->needs(procedural)
        ->check(positive_number_error, "NUMBER > 0")
        ->capture_default_str();
  };
  positive("--pitch", o->pitch_m, "Of stripes: wavelength; of dots: least distance of centres; m");
  positive("--height", o->height_m, "Of stripes: peak to valley; of dots: of their tops; m");
  sub.add_option("--diameter", o->diameter_m, "Of dots, m; by default 0.6 of the pitch")
      ->needs(procedural)
      ->check(positive_number_error, "NUMBER > 0");
  sub.add_option("--direction", o->direction, "Across the stripes, in the mesh's axes")
      ->needs(procedural)
      ->delimiter(',')
      ->type_name("X,Y,Z");
  positive("--rms", o->rms_m, "Of noise: its roughness Rq, m");
  sub.add_option("--spectral-slope", o->spectral_slope, "Of noise: exponent by which its profiles' spectrum falls")
      ->needs(procedural)
      ->check(CLI::Range(0.0, 6.0))
      ->capture_default_str();
  sub.add_option("--wavelengths", o->wavelengths_m, "Of noise: the band in which its spectrum falls, m")
      ->needs(procedural)
      ->delimiter(',')
      ->type_name("SHORT,LONG");
  sub.add_option("--seed", o->seed, "Of dots and noise")
      ->needs(procedural)
      ->check(whole_number_error, "INTEGER >= 0")
      ->capture_default_str();
}

result<relief_job> make_relief(const relief_options& options, const triangle_mesh& mesh, const std::string& file) {
  const std::string kind = options.kind();
  if (kind.empty()) return relief_job{};
  result<relief_job> made = kind == "material"     ? from_material(options, mesh, file)
                            : kind == "height map" ? from_height_map(options, mesh)
                            : kind == "normal map" ? from_normal_file(options, mesh)
                                                   : by_formula(options, mesh);
  if (!made) return made.error();
  const bake::relief_extent extent = bake::measure_relief(mesh, made->relief);
  json document = {{"kind", kind},
                   {"lowest", extent.lowest_m},
                   {"highest", extent.highest_m},
                   {"mean", extent.mean_m},
                   {"rms", extent.rms_m}};
  document.update(made->document);
  made->document = std::move(document);
  made->text += row("added relief", length_text(extent.lowest_m) + " to " + length_text(extent.highest_m) + ", RMS " +
                                        length_text(extent.rms_m));
  return made;
}

}  // namespace asperity::command
