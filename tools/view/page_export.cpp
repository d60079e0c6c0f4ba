#include <cstddef>
#include <cstdint>

#include "view/page_files.hpp"

namespace asperity::view {
namespace {

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t three = 0;
    const std::size_t here = bytes.size() - i < 3 ? bytes.size() - i : 3;
    for (std::size_t k = 0; k < 3; ++k) {
      three = three << 8U | (k < here ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    }
    for (std::size_t k = 0; k < 4; ++k) out += k <= here ? digits[three >> (18 - 6 * k) & 63U] : '=';
  }
  return out;
}

// JSON inside a page: no name can end the element that it stands in.
std::string escaped(std::string_view json) {
  std::string out;
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";
    } else {
      out += c;
    }
  }
  return out;
}

void replace(std::string& in, std::string_view what, std::string_view by) {
  const std::size_t at = in.find(what);
  if (at != std::string::npos) in.replace(at, what.size(), by);
}

std::string data_element(std::string_view id, std::string_view type, std::string_view text) {
  return "<script type=\"" + std::string(type) + "\" id=\"" + std::string(id) + "\">" + std::string(text) +
         "</script>\n";
}

}  // namespace

std::string export_page(const page_content& content) {
  const std::span<const page_file> files = page_files();
  std::string page(files.front().bytes);
  std::string data = data_element("data-scene", "application/json", escaped(content.document));
  for (std::size_t i = 0; i < content.meshes.size(); ++i) {
    data += data_element("data-mesh-" + std::to_string(i), "application/base64", base64(content.meshes[i]));
  }
  for (std::size_t i = 0; i < content.rows.size(); ++i) {
    data += data_element("data-rows-" + std::to_string(i), "application/base64", base64(content.rows[i]));
  }
  for (const page_file& f : files) {
    const std::string name(f.path.substr(1));
    if (f.type.starts_with("text/css")) {
      replace(page, "<link rel=\"stylesheet\" href=\"" + name + "\">", "<style>" + std::string(f.bytes) + "</style>");
    } else if (f.type.starts_with("text/javascript")) {
      replace(page, "<script src=\"" + name + "\" defer></script>", "");
      data += "<script>" + std::string(f.bytes) + "</script>\n";
    }
  }
  // What is in the page may run; nothing is fetched from anywhere.
  replace(page, "<!-- policy -->",
          "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src 'unsafe-inline'; "
          "style-src 'unsafe-inline'; img-src blob: data:; base-uri 'none'; form-action 'none'\">");
  replace(page, "<!-- data -->", data);
  return page;
}

}  // namespace asperity::view
