// From a mesh to a textured model.
#include "asperity/bake/bake.hpp"
#include "asperity/bake/repair.hpp"
#include "asperity/bake/wrap.hpp"
#include "asperity/field/field_body.hpp"
#include "asperity/io/textured_model_file.hpp"
#include "errors.hpp"
#include "long_work.hpp"
#include "model_handle.hpp"
#include "parts.hpp"

namespace asperity::python {
namespace {

/// What a bake was asked; the thread that bakes owns it.
struct bake_order {
  std::shared_ptr<const triangle_mesh> full;
  bake::bake_settings settings;
  std::string repair = "keep";
  bool wrap = false;
  bool keep_field = true;
  std::optional<material> surface;
};

struct baked {
  model_handle model;
  std::vector<std::string> remarks;
};

result<void> mend(const bake_order& order, triangle_mesh& mesh, work_monitor& monitor,
                  std::vector<std::string>& remarks) {
  const auto enter = [&](std::string_view stage, double done) { return monitor.enter(stage, done); };
  bool wrap = order.wrap;
  if (!wrap && order.repair != "strict") {
    if (!enter("repair", 0.0)) return error{error_code::cancelled, "cancelled: nothing was written"};
    const result<bake::repair_report> mended = bake::repair(mesh, {.threads = order.settings.threads});
    if (!mended && (order.repair != "wrap" || mended.error().code != error_code::bad_mesh)) return mended.error();
    if (mended && mended->total() > 0) {
      for (std::size_t k = 0; k < bake::repair_kinds; ++k) {
        const auto kind = static_cast<bake::repair_kind>(k);
        if (const std::size_t n = (*mended)[kind].count; n > 0)
          remarks.push_back("repaired: " + std::to_string(n) + " " + in_words(kind, n));
      }
    }
    if (!mended) {
      remarks.push_back("wrapped, since it could not be repaired: " + mended.error().message);
      wrap = true;
    }
  }
  if (!wrap) return {};
  bake::wrap_report unused;
  result<triangle_mesh> around = bake::wrap(mesh, {.threads = order.settings.threads, .progress = enter}, unused);
  if (!around) return around.error();
  mesh = std::move(*around);
  return {};
}

result<baked> run(bake_order& order, work_monitor& monitor) {
  baked out;
  triangle_mesh full = *order.full;
  order.full.reset();
  if (const result<void> ok = mend(order, full, monitor, out.remarks); !ok) return ok.error();
  order.settings.progress = [&](std::string_view stage, double done) { return monitor.enter(stage, done); };
  order.settings.remark = [&](std::string_view sentence) { out.remarks.emplace_back(sentence); };
  result<textured_model> model = bake::bake(std::move(full), order.settings);
  if (!model) return model.error();
  *model = io::as_saved(std::move(*model));
  model->surface = std::move(order.surface);
  if (order.keep_field) {
    if (!monitor.enter("field", 0.0)) return error{error_code::cancelled, "cancelled: nothing was written"};
    result<field_body> field = make_field_body(*model, {.field = {.threads = order.settings.threads}});
    if (field) {
      model->field = std::make_shared<const field_body>(std::move(*field));
    } else {
      out.remarks.push_back("no depth field is kept, and only formulation='window' can render the model: " +
                            field.error().message);
    }
  }
  out.model = model_handle::of(std::move(*model));
  return out;
}

py::tuple bake_mesh(const mesh_handle& mesh, const std::string& name, std::optional<std::size_t> triangles,
                    std::uint32_t texture, const std::optional<mesh_handle>& coarse, std::optional<std::size_t> pieces,
                    const std::string& repair, bool wrap, std::optional<material> surface, bool field, unsigned threads,
                    const py::object& progress) {
  if (repair != "keep" && repair != "wrap" && repair != "strict") {
    throw py::value_error("repair is '" + repair + "': give keep, wrap or strict");
  }
  bake_order order{.full = mesh.inside,
                   .settings = {},
                   .repair = repair,
                   .wrap = wrap,
                   .keep_field = field,
                   .surface = std::move(surface)};
  order.settings.name = name;
  order.settings.triangles = triangles.value_or(order.settings.triangles);
  order.settings.more_triangles = !triangles;
  order.settings.texture_size = texture;
  order.settings.pieces = pieces;
  order.settings.threads = threads;
  if (coarse) order.settings.coarse = *coarse->inside;
  const auto work = [order = std::move(order)](work_monitor& monitor) mutable { return run(order, monitor); };
  baked out = run_interruptibly<baked>(work, progress);
  return py::make_tuple(std::move(out.model), std::move(out.remarks));
}

}  // namespace

void add_baking(py::module_& m) {
  m.def("bake_mesh", &bake_mesh, py::arg("mesh"), py::kw_only(), py::arg("name"), py::arg("triangles"),
        py::arg("texture"), py::arg("coarse"), py::arg("pieces"), py::arg("repair"), py::arg("wrap"),
        py::arg("material"), py::arg("field"), py::arg("threads"), py::arg("progress"),
        "(Model, remarks) of a Mesh; asperity.bake() is the way in.");
}

}  // namespace asperity::python
