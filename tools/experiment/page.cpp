// The report: one HTML file with everything in it.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "output_file.hpp"
#include "publish.hpp"
#include "text.hpp"

namespace asperity::experiment {
namespace {

// Colours of both schemes have a contrast of 4.5 or more. Figures are drawn on white: a dark page shows them inverted
// with their hues turned back, so that a line keeps its colour.
constexpr std::string_view style = R"css(
:root { color-scheme: light dark; --ink: #1b1b1b; --soft: #595959; --paper: #ffffff; --tint: #f3f3f1; --rule: #d6d6d2;
  --link: #0b5394; --good: #136c3a; --bad: #b3261e; }
@media (prefers-color-scheme: dark) {
  :root { --ink: #e6e6e3; --soft: #a9a9a4; --paper: #161616; --tint: #212120; --rule: #3c3c3a; --link: #8ab8ea;
    --good: #7fcf9c; --bad: #ff9a90; }
  figure svg { filter: invert(0.92) hue-rotate(180deg); }
}
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 68rem; padding: 1.5rem 1rem 4rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.5 system-ui, sans-serif; overflow-wrap: break-word; }
h1 { font-size: 1.6rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.3rem; margin: 3rem 0 .25rem; padding-top: .75rem; border-top: 1px solid var(--rule); }
h3 { font-size: 1rem; margin: 1.75rem 0 .4rem; }
p { margin: .5rem 0; max-width: 46rem; }
a { color: var(--link); }
.facts, .see, .files { color: var(--soft); }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; font-variant-numeric: tabular-nums; }
th, td { text-align: left; vertical-align: top; padding: .3rem .75rem .3rem 0; border-bottom: 1px solid var(--rule); }
th { font-weight: 600; color: var(--soft); }
td.number, th.number { text-align: right; white-space: nowrap; }
td.word { white-space: nowrap; }
td.claim { min-width: 14rem; }
code { font: .9em ui-monospace, monospace; }
.holds { color: var(--good); font-weight: 600; }
.fails { color: var(--bad); font-weight: 600; }
figure { margin: 1.25rem 0; }
figure svg { display: block; width: 100%; min-width: 40rem; height: auto; }
figcaption { margin-top: .4rem; max-width: 46rem; }
ul { padding-left: 1.2rem; max-width: 46rem; }
@media print {
  :root { --ink: #000; --soft: #444; --paper: #fff; --tint: #fff; --rule: #bbb; --link: #000; --good: #000; --bad: #000; }
  body { max-width: none; padding: 0; font-size: 10pt; }
  figure svg { min-width: 0; filter: none; }
  .scroll { overflow: visible; }
  figure, tr { break-inside: avoid; }
  h2, h3 { break-after: avoid; }
}
)css";

std::string escaped(std::string_view words) {
  std::string out;
  for (const char c : words) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

std::string tagged(std::string_view tag, std::string_view words, std::string_view kind = {}) {
  std::string out = "<" + std::string(tag);
  if (!kind.empty()) out += " class=\"" + std::string(kind) + '"';
  return out + ">" + escaped(words) + "</" + std::string(tag) + ">";
}

void replace_all(std::string& in, std::string_view from, std::string_view to) {
  for (std::size_t at = in.find(from); at != std::string::npos; at = in.find(from, at + to.size())) {
    in.replace(at, from.size(), to);
  }
}

// Removes NAME="..." from the tag that begins at `tag`.
void drop_attribute(std::string& svg, std::size_t tag, std::string_view name) {
  const std::string opening = ' ' + std::string(name) + "=\"";
  const std::size_t from = svg.find(opening, tag);
  if (from == std::string::npos || from > svg.find('>', tag)) return;
  svg.erase(from, svg.find('"', from + opening.size()) + 1 - from);
}

// Part of a page: HTML needs no namespaces, the page decides on the size, and names of parts (letters, clips) must not
// be those of another picture's.
result<std::string> inline_svg(const figure& f, const std::string& name_prefix) {
  std::string svg;
  const result<void> drawn = command::draw(f.page, command::plot_format::svg, [&](std::string_view bytes) {
    svg += bytes;
    return result<void>();
  });
  if (!drawn) return drawn.error();
  const std::size_t begin = svg.find("<svg");
  if (begin == std::string::npos) {
    return error{error_code::io_failed, "the figure " + f.name + " could not be drawn: Cairo gave no SVG"};
  }
  svg.erase(0, begin);
  for (const char* name : {"xmlns", "xmlns:xlink", "width", "height", "version"}) drop_attribute(svg, 0, name);
  replace_all(svg, " xlink:href=\"#", " href=\"#" + name_prefix);
  replace_all(svg, " id=\"", " id=\"" + name_prefix);
  replace_all(svg, "url(#", "url(#" + name_prefix);
  svg.insert(4, " role=\"img\" aria-label=\"" + escaped(f.see) + '"');
  return svg;
}

std::size_t held(const findings& found) {
  return static_cast<std::size_t>(
      std::count_if(found.statements.begin(), found.statements.end(), [](const statement& s) { return s.holds(); }));
}

std::string held_text(std::size_t held_count, std::size_t all) {
  return std::to_string(held_count) + " of " + std::to_string(all) + " hold";
}

const char* held_class(std::size_t held_count, std::size_t all) { return held_count == all ? "holds" : "fails"; }

std::string value_text(double v) { return std::isfinite(v) ? command::brief(v) : "no number"; }

std::string contents(std::span<const published> all) {
  std::string out = "<nav><h3>Contents</h3>\n<div class=\"scroll\"><table>\n";
  for (const published& one : all) {
    const std::size_t n = held(one.found), m = one.found.statements.size();
    out += "<tr><td><a href=\"#" + escaped(one.what->name) + "\">" + escaped(one.what->title) + "</a></td>" +
           tagged("td", held_text(n, m), std::string("word ") + held_class(n, m)) + "</tr>\n";
  }
  return out + "</table></div></nav>\n";
}

std::string verdicts(const std::vector<statement>& statements) {
  std::string out =
      "<h3>Statements</h3>\n<div class=\"scroll\"><table>\n<tr><th>statement</th><th class=\"number\">value</th>"
      "<th>bound</th><th>verdict</th><th>what it says</th></tr>\n";
  for (const statement& s : statements) {
    out += "<tr><td class=\"word\">" + tagged("code", s.name) + "</td>" + tagged("td", value_text(s.value), "number") +
           tagged("td", bound_text(s), "word") +
           (s.holds() ? tagged("td", "holds", "word holds") : tagged("td", "FAILS", "word fails")) +
           tagged("td", s.claim, "claim") + "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string shown(const shown_table& t) {
  std::string out = tagged("h3", t.title) + "\n<div class=\"scroll\"><table>\n<tr>";
  for (const std::string& cell : t.header) out += tagged("th", cell);
  out += "</tr>\n";
  for (const auto& row : t.rows) {
    out += "<tr>";
    for (const std::string& cell : row) out += tagged("td", cell);
    out += "</tr>\n";
  }
  return out + "</table></div>\n";
}

std::string files(const published& one) {
  const std::string folder = one.what->name;
  std::string out = "<p class=\"files\">Files: ";
  const auto link = [&](const std::string& file) {
    return "<a href=\"" + escaped(folder + '/' + file) + "\">" + escaped(file) + "</a>";
  };
  out += link("verdict.json");
  for (const table& t : one.found.tables) out += ", " + link(t.name + ".csv");
  for (const figure& f : one.found.figures) out += ", " + link(f.name + ".png");
  return out + "</p>\n";
}

result<std::string> section(const published& one) {
  const std::size_t n = held(one.found), m = one.found.statements.size();
  std::string out = "<section>\n<h2 id=\"" + escaped(one.what->name) + "\">" + escaped(one.what->title) + "</h2>\n" +
                    tagged("p", one.what->purpose) + "\n<p>" + tagged("span", held_text(n, m), held_class(n, m)) +
                    ". " + tagged("code", "asperity experiment " + std::string(one.what->name)) + "</p>\n";
  for (std::size_t i = 0; i < one.found.figures.size(); ++i) {
    const figure& f = one.found.figures[i];
    result<std::string> svg = inline_svg(f, std::string(one.what->name) + '-' + std::to_string(i) + '-');
    if (!svg) return svg.error();
    out += "<figure><div class=\"scroll\">" + *svg + "</div>\n" + tagged("figcaption", f.see) + "</figure>\n";
  }
  for (const shown_table& t : one.found.shown) out += shown(t);
  out += verdicts(one.found.statements);
  if (!one.found.notes.empty()) {
    out += "<h3>Notes</h3>\n<ul>\n";
    for (const std::string& note : one.found.notes) out += tagged("li", note) + "\n";
    out += "</ul>\n";
  }
  return out + files(one) + "</section>\n";
}

}  // namespace

result<void> write_page(std::span<const published> all, const page_facts& facts, const std::filesystem::path& out) {
  std::size_t n = 0, m = 0;
  for (const published& one : all) {
    n += held(one.found);
    m += one.found.statements.size();
  }
  std::string page = "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  page += "<title>asperity: experiments</title>\n<style>";
  page += style;
  page += "</style>\n</head>\n<body>\n<h1>What is felt when textured objects touch: the experiments</h1>\n<p>";
  page += tagged("span", held_text(n, m), held_class(n, m)) + ".</p>\n<p class=\"facts\">" +
          escaped("asperity " + facts.version + ". " + facts.machine + ".") +
          (facts.brief ? " A brief run: fewer renderers, shorter motions and fewer points than the whole." : "") +
          "</p>\n";
  if (!facts.missing.empty()) page += tagged("p", facts.missing, "fails") + "\n";
  page += contents(all);
  for (const published& one : all) {
    result<std::string> part = section(one);
    if (!part) return part.error();
    page += *part;
  }
  page += "</body>\n</html>\n";
  result<command::output_file> opened = command::output_file::create(out / "index.html");
  if (!opened) return opened.error();
  if (const result<void> written = opened->write(page); !written) return written;
  return opened->commit();
}

}  // namespace asperity::experiment
