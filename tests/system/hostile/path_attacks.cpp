// Documents that want a file opened that is not theirs, or one that never ends. The secret lies beside the document's
// folder: ../secret.bin has the bytes that would make the mesh load.
#include <sys/stat.h>

#include "attacks.hpp"

namespace asperity::hostile {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;
using arrangement = std::function<void(const fs::path&)>;

std::string document_with(const std::string& uri) {
  json d = tetrahedron();
  d["buffers"][0]["uri"] = uri;
  return d.dump();
}

/// The uri in a .gltf, and in a .glb, which may name files too where it is no textured model.
void add(std::vector<attack>& out, const std::string& name, const std::string& uri, const std::string& says,
         const arrangement& arrange = nullptr) {
  const std::string model_says = "buffers[0].uri names data outside the file, which a textured model never does; ";
  out.push_back({name + ".gltf", "a.gltf", says, no_glb, [=](const fs::path& f) {
                   if (arrange) arrange(f);
                   write(f / "a.gltf", document_with(uri));
                 }});
  out.push_back({name + ".glb", "a.glb", says, model_says, [=](const fs::path& f) {
                   if (arrange) arrange(f);
                   write(f / "a.glb", glb(document_with(uri), ""));
                 }});
}

void make_pipe(const fs::path& at) { static_cast<void>(::mkfifo(at.c_str(), 0600)); }

/// A picture of 16384 x 16384 by its header; decoding it takes a gigabyte.
std::string huge_picture() {
  std::string png("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\x40\0\0\0\x40\0\x08\x06\0\0\0", 29);
  png += std::string("\0\0\0\0\0\x10\0\0IDAT\x78\x01", 14);
  return png + std::string(4096, '\0');
}

}  // namespace

std::vector<attack> path_attacks() {
  const std::string out_of = "buffers[0].uri leads out of the document's folder; put the buffer beside it";
  const std::string odd = "buffers[0].uri holds a backslash or a control character; give the buffer a plain name";
  const std::string link = " is or lies behind a link, which is not followed; put the file there";
  std::vector<attack> out;
  add(out, "A14_parent", "../secret.bin", out_of);
  add(out, "A14b_system_file", std::string("../../../../../../../..") + system_file, out_of);
  add(out, "A14_absolute", system_file, out_of);
  add(out, "percent_encoded_parent", "%2e%2e/secret.bin", out_of);
  add(out, "percent_encoded_slash", "..%2fsecret.bin", out_of);
  add(out, "down_and_up", "deeper/../../secret.bin", out_of,
      [](const fs::path& f) { fs::create_directory(f / "deeper"); });
  add(out, "file_scheme", std::string("file://") + system_file, out_of);
  add(out, "http_scheme", "http://127.0.0.1:1/secret.bin", out_of);
  add(out, "backslashes", "..\\secret.bin", odd);
  add(out, "nul_in_the_uri", "data.bin%00/../../secret.bin", odd);
  add(out, "line_break_in_the_uri", "data\n.bin", odd);
  add(out, "broken_percent", "%zz", "buffers[0].uri has a broken % code; ");
  add(out, "empty_uri", "", out_of);
  add(out, "the_folder_itself", ".", out_of);
  add(out, "link_that_leads_out", "link.bin", "link.bin:" + link,
      [](const fs::path& f) { fs::create_symlink("../secret.bin", f / "link.bin"); });
  add(out, "folder_link_that_leads_out", "link/secret.bin", "link/secret.bin:" + link,
      [](const fs::path& f) { fs::create_directory_symlink("..", f / "link"); });
  add(out, "link_to_a_device", "zero.bin", "zero.bin:" + link,
      [](const fs::path& f) { fs::create_symlink("/dev/zero", f / "zero.bin"); });
  add(out, "A17_pipe", "pipe.bin", "pipe.bin: is not a regular file; save its contents to one first",
      [](const fs::path& f) { make_pipe(f / "pipe.bin"); });
  add(out, "A18_directory", "folder", "folder: is a directory; name a file in it",
      [](const fs::path& f) { fs::create_directory(f / "folder"); });
  add(out, "file_as_a_folder", "data.bin/more", "more: cannot be found; check the path",
      [](const fs::path& f) { write(f / "data.bin", tetrahedron_bytes()); });
  add(out, "absent", "absent.bin", "absent.bin: cannot be found; check the path");
  add(out, "empty_file", "empty.bin", "empty.bin: is empty; export it again",
      [](const fs::path& f) { write(f / "empty.bin", ""); });
  add(out, "sparse_3_GiB_buffer", "big.bin", "big.bin: has 3221225472 bytes, more than the limit of 2147483648; ",
      [](const fs::path& f) {
        write(f / "big.bin", "");
        fs::resize_file(f / "big.bin", std::uintmax_t{3} << 30);
      });

  // The document itself.
  const std::string pipe = "a.gltf: is not a regular file; save its contents to one first";
  out.push_back({"pipe_as_document", "a.gltf", pipe, pipe, [](const fs::path& f) { make_pipe(f / "a.gltf"); }});
  out.push_back({"device_as_document", "a.glb", "is not a regular file; ", "is not a regular file; ",
                 [](const fs::path& f) { fs::create_symlink("/dev/zero", f / "a.glb"); }});
  out.push_back({"folder_as_document", "a.glb", "is a directory; ", "is a directory; ",
                 [](const fs::path& f) { fs::create_directory(f / "a.glb"); }});

  // One small file named many times would take its size as often.
  out.push_back({"one_file_as_many_buffers.gltf", "a.gltf",
                 "buffers[1].uri names a file that another buffer has named; ", no_glb, [](const fs::path& f) {
                   json d = tetrahedron();
                   for (std::size_t i = 0; i < 60; ++i) {
                     d["buffers"][i] = {{"uri", i % 2 == 0 ? "d.bin" : "./x/../%64.bin"}, {"byteLength", 96}};
                   }
                   write(f / "d.bin", std::string(1U << 20, 'x'));
                   write(f / "a.gltf", d.dump());
                 }});
  out.push_back(
      {"65_buffers.gltf", "a.gltf", "has 65 buffers, more than the limit of 64; ", no_glb, [](const fs::path& f) {
         json d = tetrahedron();
         d["buffers"] = json(65, {{"uri", "d.bin"}, {"byteLength", 1}});
         write(f / "a.gltf", d.dump());
       }});
  out.push_back({"broken_data_uri.gltf", "a.gltf", "buffers[0].", no_glb, [](const fs::path& f) {
                   write(f / "a.gltf", document_with("data:application/octet-stream;base64,!!!!"));
                 }});

  // Pictures are never opened and never decoded, so these load.
  const auto with_image = [](const json& image) {
    return [image](const fs::path& f) {
      make_pipe(f / "pipe.png");
      write(f / "bomb.png", huge_picture());
      test_support::glb_editor model(good_model());
      model.json["images"] = {image};
      write(f / "a.glb", model.bytes());
    };
  };
  out.push_back({"A17_picture_is_a_pipe", "a.glb", "", "", with_image({{"uri", "pipe.png"}})});
  out.push_back({"A9_picture_of_16384", "a.glb", "", "", with_image({{"uri", "bomb.png"}})});
  out.push_back({"picture_outside", "a.glb", "", "", with_image({{"uri", "../secret.bin"}})});
  out.push_back(
      {"A9_picture_of_16384_inside", "a.glb", "", "", [](const fs::path& f) {
         test_support::glb_editor model(good_model());
         const std::string png = huge_picture();
         model.json["images"] = {{{"bufferView", model.json["bufferViews"].size()}, {"mimeType", "image/png"}}};
         model.json["bufferViews"].push_back(
             {{"buffer", 0}, {"byteOffset", model.bin.size()}, {"byteLength", png.size()}});
         model.bin += png;
         model.bin.resize((model.bin.size() + 3) / 4 * 4);
         model.json["buffers"][0]["byteLength"] = model.bin.size();
         write(f / "a.glb", model.bytes());
       }});
  return out;
}

}  // namespace asperity::hostile
