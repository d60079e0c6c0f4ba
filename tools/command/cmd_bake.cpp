// asperity bake: from a full-resolution mesh to a textured model.
#include <filesystem>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "asperity/bake/bake.hpp"
#include "asperity/bake/map_materials.hpp"
#include "asperity/bake/repair.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/io/image_file.hpp"
#include "asperity/io/mesh_file.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "bake_document.hpp"
#include "cli.hpp"
#include "file_names.hpp"
#include "interrupt.hpp"
#include "material_option.hpp"
#include "mesh_placing.hpp"
#include "mesh_units.hpp"
#include "model_drawing.hpp"
#include "options.hpp"
#include "output_file.hpp"
#include "progress.hpp"
#include "relief_options.hpp"
#include "split_bake.hpp"
#include "text.hpp"
#include "wrap_option.hpp"

namespace asperity::command {
namespace {

namespace fs = std::filesystem;

struct bake_command {
  std::string full;
  std::string coarse;
  std::string out;
  std::string picture;
  std::string name;
  std::string material;
  std::string material_map;
  std::vector<std::string> material_at;
  std::optional<std::size_t> triangles;
  std::uint32_t texture = 1024;
  std::string texels = "point";
  unsigned threads = 0;
  std::optional<std::size_t> pieces;
  bool keep_uvs = false;
  bool close_holes = false;  // holes are closed anyway: the option is taken for those who gave it before
  bool strict = false;
  std::string repair = "keep";
  bool without_field = false;
  bool split = false;
  std::optional<triangle_mesh> part{};  // to be baked in place of the file's mesh
  std::shared_ptr<mesh_units> units = std::make_shared<mesh_units>();
  std::shared_ptr<mesh_placing> placing = std::make_shared<mesh_placing>();
  std::shared_ptr<wrap_options> wrap = std::make_shared<wrap_options>();
  std::shared_ptr<relief_options> relief = std::make_shared<relief_options>();
};

result<void> check_paths(const bake_command& options) {
  std::vector<named_file> inputs = mesh_files(options.full, "the bake");
  const std::vector<named_file> coarse = mesh_files(options.coarse, "--coarse");
  inputs.insert(inputs.end(), coarse.begin(), coarse.end());
  for (const std::string& image : options.relief->inputs()) inputs.push_back({"the relief", image});
  if (!preset_material(options.material)) inputs.push_back({"--material", options.material});
  inputs.push_back({"--material-map", options.material_map});
  for (const std::string& at : options.material_at) inputs.push_back({"--material-at", file_of_material_at(at)});
  const std::vector<named_file> outputs{{"-o", options.out}, {"--picture", options.picture}};
  if (const result<void> ok = check_outputs(inputs, outputs); !ok) return ok;
  return check_writable(options.out);
}

/// An image of materials and what its colours stand for; nothing where none was asked for.
struct material_image {
  map_image image;
  std::vector<bake::material_colour> colours;
};
result<std::optional<material_image>> read_material_map(const bake_command& options) {
  if (options.material_map.empty()) return std::optional<material_image>{};
  material_image out;
  for (const std::string& at : options.material_at) {
    result<bake::material_colour> colour = read_material_at(at);
    if (!colour) return colour.error();
    out.colours.push_back(std::move(*colour));
  }
  result<map_image> image = io::load_image(options.material_map, not_interrupted);
  if (!image) return image.error();
  out.image = std::move(*image);
  return std::optional(std::move(out));
}

result<answer> run_bake(const bake_command& options, const common_options& common) {
  if (const result<void> ok = check_paths(options); !ok) return ok.error();
  std::optional<material> surface;
  if (!options.material.empty()) {
    result<material> read = read_material_option(options.material);
    if (!read) return read.error();
    surface = std::move(*read);
  }
  const result<std::optional<material_image>> mapped = read_material_map(options);
  if (!mapped) return mapped.error();

  std::optional<output_file> drawing;
  if (!options.picture.empty()) {
    result<output_file> opened = output_file::create(options.picture);
    if (!opened) return opened.error();
    drawing.emplace(std::move(*opened));
  }
  progress_line progress(common.quiet);
  stage_clock clock;
  const auto enter = [&](std::string_view stage, double done) {
    clock.enter(stage);
    progress.show(stage, done);
    return !interrupted();
  };

  enter("read", 0.0);
  result<triangle_mesh> full = options.part ? *options.part : io::load_mesh(options.full, not_interrupted);
  if (!full) return full.error();
  if (const result<void> ok = fit_scale(*options.placing, options.full, *full, *options.units); !ok) return ok.error();
  if (const result<void> ok = bring_to_metres(*options.units, options.full, *full); !ok) return ok.error();
  turn_up(options.placing->up, *full);
  std::vector<std::string> remarks;
  const bool can_be_wrapped = !options.wrap->wanted && bake::can_wrap(*full);
  std::optional<bake::wrap_report> wrapped;
  const auto wrap = [&]() -> result<void> {
    if (options.keep_uvs && options.coarse.empty())
      return error{
          error_code::invalid_argument,
          "--keep-uvs: a wrapped mesh has no texture coordinates; leave --wrap and --repair wrap out, or give a "
          "--coarse mesh"};
    result<triangle_mesh> around = bake::wrap(*full,
                                              {.cell_m = options.wrap->cell_m,
                                               .thickness_m = options.wrap->thickness_m,
                                               .threads = options.threads,
                                               .progress = enter},
                                              wrapped.emplace());
    if (!around) return around.error();
    *full = std::move(*around);
    return {};
  };
  bake::repair_report repaired;
  repaired.triangles_before = repaired.triangles_after = full->triangles.size();
  if (options.wrap->wanted) {
    if (const result<void> ok = wrap(); !ok) return ok.error();
  } else if (!options.strict) {
    if (!enter("repair", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
    const result<bake::repair_report> mended = bake::repair(*full, {.threads = options.threads});
    if (mended) {
      repaired = *mended;
    } else if (options.repair == "wrap" && mended.error().code == error_code::bad_mesh) {
      remarks.push_back("wrapped, since it could not be repaired: " + mended.error().message);
      if (const result<void> ok = wrap(); !ok) return ok.error();
    } else {
      return with_offer_to_wrap(mended.error(), can_be_wrapped);
    }
    if (options.keep_uvs && options.coarse.empty() && repaired.triangles_added > 0) {
      return error{error_code::invalid_argument,
                   "--keep-uvs: the triangles that close the holes of " + options.full +
                       " have no texture coordinates; close them where the mesh is unwrapped, or give a --coarse mesh"};
    }
  }

  if (*mapped && full->uvs.size() != full->triangles.size()) {
    return error{error_code::bad_mesh, "--material-map: " + options.full +
                                           " has no texture coordinates, so no image can be laid on it; export it with "
                                           "its UVs (OBJ, glTF)" +
                                           (repaired.triangles_added > 0 ? ", and close its holes there"
                                            : wrapped                    ? "; a wrapped mesh has none"
                                                                         : "")};
  }

  bake::bake_settings settings;
  settings.name = options.name.empty() ? fs::path(options.full).stem().string() : options.name;
  settings.triangles = options.triangles.value_or(settings.triangles);
  settings.more_triangles = !options.triangles;
  settings.texture_size = options.texture;
  settings.texels = options.texels == "highest" ? bake::texel_filter::highest
                    : options.texels == "mean"  ? bake::texel_filter::mean
                                                : bake::texel_filter::point;
  settings.pieces = options.pieces;
  settings.keep_uvs = options.keep_uvs;
  settings.threads = options.threads;
  settings.progress = enter;
  if (!options.relief->kind().empty() && !enter("relief", 0.0))
    return error{error_code::cancelled, "interrupted: nothing was written"};
  result<relief_job> relief = make_relief(*options.relief, *full, options.full);
  if (!relief) return relief.error();
  settings.relief = relief->relief;
  remarks.insert(remarks.end(), relief->notes.begin(), relief->notes.end());
  settings.remark = [&](std::string_view sentence) { remarks.emplace_back(sentence); };
  if (!options.coarse.empty()) {
    result<triangle_mesh> coarse = io::load_mesh(options.coarse, not_interrupted);
    if (!coarse) return coarse.error();
    scale_to_metres(*options.units, *coarse);
    turn_up(options.placing->up, *coarse);
    settings.coarse = std::move(coarse).value();
  }
  // A mesh that the picture does not need is not kept twice.
  result<textured_model> model =
      (drawing && !settings.relief) || *mapped ? bake::bake(*full, settings) : bake::bake(std::move(*full), settings);
  if (!model) return with_offer_to_wrap(model.error(), can_be_wrapped);
  *model = io::as_saved(std::move(*model));
  model->surface = std::move(surface);
  if (*mapped) {
    if (!enter("materials", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
    result<bake::laid_materials> laid =
        bake::lay_materials(*model, *full, (*mapped)->image, (*mapped)->colours,
                            {.threads = options.threads, .keep_going = not_interrupted});
    if (!laid) return error{laid.error().code, options.material_map + ": " + laid.error().message};
    model->surface = std::move(laid->surface);
    model->surface_map = std::move(laid->map);
    constexpr double many = 0.01;
    if (laid->far_share > many) {
      remarks.push_back(brief(100.0 * laid->far_share) +
                        " % of the texels lie where the map of materials has a colour that none of --material-at is "
                        "near to; they have the nearest one's material");
    }
  }
  if (!options.without_field) {
    if (!enter("field", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
    result<field_body> field = make_field_body(*model, {.field = {.threads = options.threads}});
    if (field) {
      model->field = std::make_shared<const field_body>(std::move(*field));
    } else {
      remarks.push_back("no depth field is kept, and only --contacts window can render the model: " +
                        field.error().message);
    }
  }

  json picture;
  if (drawing) {
    picture::picture_options page;
    if (!settings.relief) {  // with one, the mesh is not what the textured surface should be
      page.original = &*full;
      page.original_name = fs::path(options.full).filename().string() + (wrapped ? ", wrapped" : "");
    }
    page.threads = options.threads;
    page.progress = enter;
    result<json> drawn = write_picture(*model, page, *drawing);
    if (!drawn) return drawn.error();
    picture = {{"file", options.picture}};
    picture.update(*drawn);
  }
  if (!enter("write", 0.0)) return error{error_code::cancelled, "interrupted: nothing was written"};
  if (const result<void> saved = io::save_textured_model(*model, options.out); !saved) return saved.error();
  if (drawing) {
    if (const result<void> kept = drawing->commit(); !kept) return kept.error();
  }
  clock.leave();
  answer out = report_bake(
      {options.full, options.out, *model, options.units->metres_per_unit(), options.keep_uvs, repaired, *relief, clock},
      std::move(remarks));
  if (wrapped) {
    out.document["wrap"] = wrap_document(*wrapped);
    out.text += wrap_text(*wrapped);
  }
  if (drawing) {
    out.document["picture"] = std::move(picture);
    out.text += row("picture", options.picture);
  }
  return out;
}

// One model for each part of the file. One scale holds for all of them, that of the whole.
result<answer> run_split(const bake_command& options, const common_options& common) {
  if (const result<void> ok = check_paths(options); !ok) return ok.error();
  result<std::vector<io::mesh_part>> parts = io::load_mesh_parts(options.full, not_interrupted);
  if (!parts) return parts.error();
  const std::vector<std::string> files = files_of_parts(*parts, options.out);
  std::vector<named_file> outputs;
  for (const std::string& file : files) outputs.push_back({"--split", file});
  if (const result<void> ok = check_outputs(mesh_files(options.full, "the bake"), outputs); !ok) return ok.error();

  bake_command each = options;
  each.units = std::make_shared<mesh_units>(*options.units);
  each.placing = std::make_shared<mesh_placing>(*options.placing);
  triangle_mesh whole;
  for (const io::mesh_part& part : *parts)
    whole.positions.insert(whole.positions.end(), part.mesh.positions.begin(), part.mesh.positions.end());
  if (const result<void> ok = fit_scale(*options.placing, options.full, whole, *each.units); !ok) return ok.error();
  if (const result<void> ok = bring_to_metres(*each.units, options.full, whole); !ok) return ok.error();
  each.units->scale = each.units->metres_per_unit();
  each.placing->fit_m.reset();
  return bake_parts(options.full, files, [&](std::size_t k, const std::string& file) {
    each.part = std::move((*parts)[k].mesh);
    each.out = file;
    each.name = (options.name.empty() ? "" : options.name + " ") + fs::path(files[k]).stem().string();
    return run_bake(each, common);
  });
}

}  // namespace

void add_bake(command_line& line) {
  const auto o = std::make_shared<bake_command>();
  CLI::App& sub =
      line.add("bake", "Turn a full-resolution mesh into a textured model",
               [o](const common_options& common) { return o->split ? run_split(*o, common) : run_bake(*o, common); });
  sub.add_option("full", o->full,
                 "Full-resolution mesh (.ply, .obj, .stl, .gltf, .glb), in metres; repaired where it is not closed")
      ->required();
  sub.add_option("-o,--output", o->out, "Textured model to write (.glb)")
      ->required()
      ->check([](const std::string& text) { return extension_error(text, {".glb"}); }, "FILE.glb");
  auto* triangles =
      sub.add_option("--triangles", o->triangles,
                     "Triangles of the coarse mesh to aim for; by default 600, or more where the mesh has "
                     "too many handles for these")
          ->check(CLI::Range(4, 1000000));
  auto* coarse = sub.add_option("--coarse", o->coarse, "Use this mesh as the coarse mesh instead of simplifying")
                     ->excludes(triangles);
  sub.add_flag("--split", o->split,
               "Make a model of each part of the mesh: groups of an OBJ, nodes of a glTF, or surfaces that are apart; "
               "OUT-NAME.glb or OUT-1.glb and on, all or none")
      ->excludes(coarse);
  sub.add_option("--texture", o->texture, "Texels per side of the haptic texture")
      ->check(CLI::Range(16, 8192))
      ->capture_default_str();
  sub.add_option("--texels", o->texels,
                 "What a texel keeps of the surface under it: the point at its middle, the mean, or the highest, on "
                 "which a probe wider than a texel rests")
      ->check(CLI::IsMember({"point", "mean", "highest"}))
      ->capture_default_str();
  sub.add_flag("--keep-uvs", o->keep_uvs,
               "Use the coarse mesh's own texture coordinates; without --coarse, those of a full mesh that is its own");
  add_placing_options(sub, o->placing, add_unit_options(sub, o->units, "the meshes"));
  sub.add_option("--pieces", o->pieces, "Convex pieces to aim for; by default as many as the usual tolerances make")
      ->check(CLI::Range(1, 1000000));
  add_relief_options(sub, o->relief);
  auto* wrap = add_wrap_options(sub, o->wrap);
  auto* close_holes = sub.add_flag("--close-holes", o->close_holes, "Holes are closed by default; changes nothing");
  auto* strict = sub.add_flag("--strict", o->strict, "Refuse a full mesh that would have to be repaired")
                     ->excludes(close_holes)
                     ->excludes(wrap);
  sub.add_option("--repair", o->repair,
                 "What becomes of a mesh that no repair can mend: keep (it is refused) or wrap (as --wrap does)")
      ->check(CLI::IsMember({"keep", "wrap"}))
      ->capture_default_str()
      ->excludes(strict)
      ->excludes(wrap);
  sub.add_flag("--without-field", o->without_field,
               "Keep no depth field in the file, which is then about half as large; every load makes it anew");
  sub.add_option("--picture", o->picture, "Draw the model and its distance to the full mesh here (.png)")
      ->excludes("--split")
      ->check([](const std::string& text) { return extension_error(text, {".png"}); }, "FILE.png");
  sub.add_option("--name", o->name, "Name kept in the model; by default the mesh's file name without extension");
  auto* material =
      sub.add_option("--material", o->material,
                     "What the surface is like to touch: steel, wood, rubber, ice, or a material file (.json)");
  auto* map = sub.add_option("--material-map", o->material_map,
                             "Image of where which material is, by the full mesh's texture coordinates; with "
                             "--material-at")
                  ->excludes(material);
  auto* at = sub.add_option("--material-at", o->material_at,
                            "COLOUR=NAME or COLOUR=FILE: a colour of the map, as ff0000 or a grey level from 0 to 255, "
                            "and its material; once for each, 2 to 8")
                 ->expected(1)
                 ->take_all()
                 ->needs(map);
  map->needs(at);
  sub.add_option("--threads", o->threads, "Threads to use; 0 takes all. The result does not depend on it")
      ->check(CLI::Range(0, 1024))
      ->capture_default_str();
}

}  // namespace asperity::command
