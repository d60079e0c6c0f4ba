#include "wrap_option.hpp"

#include <charconv>

#include "options.hpp"
#include "text.hpp"

namespace asperity::command {
namespace {

std::string percent(double share) { return brief(100.0 * share) + " %"; }

json spread_document(const length_spread& spread) {
  return {{"p50", spread.median_m}, {"p99", spread.p99_m}, {"max", spread.max_m}};
}

std::string spread_text(const length_spread& spread) {
  return "half within " + length_text(spread.median_m) + ", 99 % within " + length_text(spread.p99_m) + ", at most " +
         length_text(spread.max_m);
}

}  // namespace

CLI::Option* add_wrap_options(CLI::App& sub, const std::shared_ptr<wrap_options>& options) {
  auto* wrap =
      sub.add_option_function<std::string>(
             "--wrap",
             [options](const std::string& size) {
               options->wanted = true;
               double cell = 0.0;
               std::from_chars(size.data(), size.data() + size.size(), cell);
               if (cell > 0.0) options->cell_m = cell;
             },
             "Wrap the full mesh in a closed surface, whatever is wrong with it. SIZE: edge of its cells, m; "
             "by default the diagonal / 200")
          ->expected(0, 1)
          ->default_str("")
          ->check([](const std::string& text) { return text.empty() ? std::string() : positive_number_error(text); },
                  "[SIZE > 0]");
  sub.add_option_function<double>(
         "--thickness", [options](double value) { options->thickness_m = value; },
         "With --wrap: thickness of the plates that open sheets and thin walls become, m; by default 2.5 cells")
      ->check(positive_number_error, "NUMBER > 0")
      ->needs(wrap);
  return wrap;
}

json wrap_document(const bake::wrap_report& report) {
  return {{"cell", report.cell_m},
          {"thickness", report.thickness_m},
          {"triangles_in", report.triangles_in},
          {"triangles", report.triangles},
          {"components", report.components},
          {"dropped_triangles", report.dropped_triangles},
          {"turned_triangles", report.turned_triangles},
          {"plate_share", report.plate_share},
          {"cavities_filled", report.cavities_filled},
          {"specks_dropped", report.specks_dropped},
          {"far", report.far_m},
          {"made_up_share", report.made_up_share},
          {"lost_share", report.lost_share},
          {"to_original", spread_document(report.to_original)},
          {"to_wrap", spread_document(report.to_wrap)}};
}

std::string wrap_text(const bake::wrap_report& report) {
  std::string out = row("wrapped", std::to_string(report.triangles_in) + " triangles as they were, in cells of " +
                                       length_text(report.cell_m));
  if (report.plate_share > 0.0)
    out +=
        row("plates", percent(report.plate_share) + " of the original, a sheet or a wall thinner than a cell, is now " +
                          length_text(report.thickness_m) + " thick");
  out += row("wrap to original", spread_text(report.to_original) + "; " + percent(report.made_up_share) +
                                     " farther than " + length_text(report.far_m) + ", made up");
  out += row("original to wrap",
             spread_text(report.to_wrap) + "; " + percent(report.lost_share) + " farther, within it or lost");
  return out;
}

error with_offer_to_wrap(error refusal, bool can_be_wrapped) {
  // What is refused of other files, as of a coarse mesh that was given, no wrap mends.
  const auto begins = [&](const char* with) { return refusal.message.rfind(with, 0) == 0; };
  const bool of_mesh = begins("the mesh ") || begins("no sound coarse mesh ");
  if (refusal.code == error_code::bad_mesh && of_mesh && can_be_wrapped)
    refusal.message += "; or add --wrap, which puts a closed surface around it as it is";
  return refusal;
}

}  // namespace asperity::command
