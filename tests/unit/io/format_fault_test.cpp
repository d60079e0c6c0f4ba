// What is wrong with a mesh file, said in one sentence with the place. One table per format.
#include <gtest/gtest.h>
#include <string>
#include <sys/stat.h>
#include <vector>

#include "asperity/io/mesh_file.hpp"
#include "scratch_folder.hpp"

namespace asperity {
namespace {

using test_support::scratch_folder;

struct faulty_file {
  std::string name;  // its extension chooses the reader
  std::string content;
  error_code code;
  std::string says;  // part of the message: the place and the fault
};

void expect_faults(const std::vector<faulty_file>& files) {
  const scratch_folder folder;
  for (const faulty_file& f : files) {
    const auto mesh = io::load_mesh(folder.file(f.name, f.content));
    ASSERT_FALSE(mesh) << f.says;
    EXPECT_EQ(mesh.error().code, f.code) << mesh.error().message;
    EXPECT_NE(mesh.error().message.find(f.says), std::string::npos) << mesh.error().message << "\nlacks: " << f.says;
    EXPECT_NE(mesh.error().message.find(f.name), std::string::npos) << mesh.error().message;
    EXPECT_EQ(mesh.error().message.find('\n'), std::string::npos) << mesh.error().message;
  }
}

std::string ply(const std::string& vertices, const std::string& faces, const std::string& body,
                const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\nelement vertex " + vertices +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
         "\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

TEST(MeshFault, Ply) {
  using enum error_code;
  const std::string three = "0 0 0\n1 0 0\n0 1 0\n";
  expect_faults({
      {"a.ply", "", bad_format, "is empty"},
      {"a.ply", "plx\n", bad_format, "line 1 is not 'ply'"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 3", bad_format, "line 3 ends before 'end_header'"},
      {"a.ply", "ply\nformat utf8 1.0\n", bad_format, "line 2 has a format other than"},
      {"a.ply", "ply\nfromat ascii 1.0\n", bad_format, "line 2 has the unknown keyword 'fromat'"},
      {"a.ply", "ply\nelement vertex many\n", bad_format, "line 2 needs a name and a number"},
      {"a.ply", "ply\nproperty float x\n", bad_format, "line 2 has a property before any element"},
      {"a.ply", "ply\nelement vertex 1\nproperty half x\n", bad_format, "unknown property type 'half'"},
      {"a.ply", "ply\nelement face 1\nproperty list float int vertex_indices\n", bad_format, "not of an integer type"},
      {"a.ply", "ply\nelement face 1\nproperty list uchar float vertex_indices\n", bad_format,
       "not of an integer type"},
      {"a.ply", ply("3", "1", three), bad_format, "(face 0)"},
      {"a.ply", ply("4", "1", three + "3 0 1 2\n"), bad_format, "line 13 follows a list length"},
      {"a.ply", ply("3", "1", three + "3 0 1\n"), bad_format, "line 14 is the end of the file within"},
      {"a.ply", ply("3", "2", three + "3 0 1 2\n4 0 1 \n"), bad_format, "line 14 follows a list length"},
      {"a.ply", ply("3", "1", three + "3 0 1 2\n3 0 1 2\n"), bad_format, "more data than the header announces"},
      {"a.ply", ply("3", "1", three + "3 0 1 3\n"), bad_format, "face 0 names vertex 3 of 3"},
      {"a.ply", ply("3", "1", three + "3 0 1 -1\n"), bad_format, "line 13 follows a vertex index"},
      {"a.ply", ply("3", "1", three + "2 0 1\n"), bad_format, "line 13 begins a face of 2 corners"},
      {"a.ply", ply("3", "1", three + "-3 0 1\n"), bad_format, "list length"},
      {"a.ply", ply("3", "1", "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), bad_format,
       "line 11 follows a coordinate that is not finite"},
      {"a.ply", ply("3", "1", "0 0 0\n1 inf 0\n0 1 0\n3 0 1 2\n"), bad_format, "not finite (vertex 1)"},
      {"a.ply", ply("3", "1", "0 0 0\n1 o 0\n0 1 0\n3 0 1 2\n"), bad_format,
       "line 11 holds something that is not a number"},
      {"a.ply", ply("3", "0", three), bad_format, "holds no faces"},
      {"a.ply", ply("99999999999999999", "1", three), bad_format, "more than the"},
      {"a.ply", ply("18446744073709551615", "1", three, "binary_little_endian"), bad_format,
       "elements 'vertex', more than"},
      {"a.ply", ply("1", "1", std::string(12, '\0') + "\xff" + "abc", "binary_little_endian"), bad_format,
       "byte 182 follows a list length"},
      {"a.ply", ply("1", "1", std::string(12, '\0') + "\3" + std::string(11, '\0'), "binary_big_endian"), bad_format,
       "list length that the rest of the file cannot hold"},
      {"a.ply", ply("1", "1", std::string(12, '\0') + "\3" + std::string(12, '\0') + "xx", "binary_big_endian"),
       bad_format, "more data than the header announces"},
      {"a.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
       bad_format, "no element 'vertex' with x, y and z"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 "
       "0\n",
       unsupported, "point cloud"},
  });
}

TEST(MeshFault, Obj) {
  using enum error_code;
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  expect_faults({
      {"a.obj", "", bad_format, "is empty"},
      {"a.obj", three, bad_format, "holds no faces"},
      {"a.obj", "v 1 2\n", bad_format, "line 1 needs three numbers after v"},
      {"a.obj", "v 1 2 x\n", bad_format, "has 'x'"},
      {"a.obj", "\nv 1 2 nan\n", bad_format, "line 2 has a coordinate that is not finite"},
      {"a.obj", "v 1 2 1e999\n", bad_format, "line 1"},
      {"a.obj", three + "f 1 2\n", bad_format, "line 4 has a face of 2 corners"},
      {"a.obj", three + "f 1 2 4\n", bad_format, "line 4 names vertex 4 of 3"},
      {"a.obj", three + "f 1 2 -4\n", bad_format, "line 4 names index -4"},
      {"a.obj", three + "f 0 1 2\n", bad_format, "line 4 has '0' where an index from 1"},
      {"a.obj", three + "f 1 2 99999999999999999999\n", bad_format, "line 4"},
      {"a.obj", three + "vt 0 0\nf 1/1 2/1 3/2\n", bad_format, "line 5 names texture coordinate 2 of 1"},
      {"a.obj", three + "vt x 0\n", bad_format, "line 4 needs finite numbers after vt"},
  });
}

TEST(MeshFault, PolygonsBeyondTheLimit) {
  const std::string three = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  std::string face = "f";
  std::string continued = "f";
  for (int i = 0; i < 65'537; ++i) {
    face += " 1";
    continued += " \\\n1";
  }
  const std::string body = std::string(36, '\0') + std::string("\1\0\1\0", 4) + std::string(4 * 65'537, '\0');
  std::string wide = ply("3", "1", body, "binary_little_endian");
  wide.replace(wide.find("list uchar"), 10, "list uint");
  const char* says = "65537 corners in one face, more than the 65536";
  expect_faults({{"a.obj", three + face + "\n", error_code::limit_exceeded, says},
                 {"b.obj", three + continued + "\n", error_code::limit_exceeded, says},
                 {"a.ply", wide, error_code::limit_exceeded, says}});
}

TEST(MeshFault, Stl) {
  using enum error_code;
  std::string binary(80, ' ');
  binary += std::string("\1\0\0\0", 4) + std::string(50, '\0');
  std::string nan = binary;
  nan.replace(84 + 12, 4, "\xff\xff\xff\xff");
  std::string huge = binary;
  huge.replace(80, 4, "\xff\xff\xff\xff");
  expect_faults({
      {"a.stl", "", bad_format, "is empty"},
      {"a.stl", "hello", bad_format, "has 5 bytes, fewer than the header"},
      {"a.stl", binary.substr(0, 130), bad_format, "announces 1 triangles, which take 134 bytes, but the file has 130"},
      {"a.stl", binary + "x", bad_format, "but the file has 135"},
      {"a.stl", huge, bad_format, "announces 4294967295 triangles"},
      {"a.stl", nan, bad_format, "byte 96 (facet 0) has a coordinate that is not finite"},
      {"a.stl", "solid\nendsolid\n", bad_format, "holds no faces"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0", bad_format,
       "line 5 needs three numbers after 'vertex'"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n", bad_format,
       "ends before 'vertex'"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n", bad_format,
       "line 4 has a coordinate that is not"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n",
       bad_format, "ends without 'endsolid'"},
      {"a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\n", bad_format,
       "line 6 has 'endloop' where 'vertex' belongs"},
  });
}

TEST(MeshFault, NotAFileThatCanBeRead) {
  const scratch_folder folder;
  const auto says = [](const std::filesystem::path& file) {
    const auto mesh = io::load_mesh(file);
    return mesh ? std::string("loaded") : std::string(to_string(mesh.error().code)) + " " + mesh.error().message;
  };
  EXPECT_NE(
      says(folder.file("absent.ply")).find("io_failed " + folder.file("absent.ply").string() + ": cannot be found"),
      std::string::npos);
  EXPECT_NE(says(folder.path()).find("is a directory"), std::string::npos);
  EXPECT_NE(says(folder.file("mesh.fbx", "x")).find("unsupported"), std::string::npos);
  EXPECT_NE(says(folder.file("mesh.fbx")).find("unknown extension '.fbx'"), std::string::npos);
  ASSERT_EQ(::mkfifo(folder.file("pipe.ply").c_str(), 0600), 0);
  EXPECT_NE(says(folder.file("pipe.ply")).find("is not a regular file"), std::string::npos);
  if (::geteuid() != 0) {
    const auto locked = folder.file("locked.ply", "ply\n");
    std::filesystem::permissions(locked, std::filesystem::perms::none);
    EXPECT_NE(says(locked).find("cannot be opened"), std::string::npos);
  }
}

TEST(MeshFault, EveryPrefixOfABinaryPlyIsRefused) {
  const scratch_folder folder;
  const std::string whole =
      ply("3", "1",
          std::string("\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0\0\0\0\0\0\0\0\0\0\0\200?\0\0\0\0", 36) +
              std::string("\3\0\0\0\0\1\0\0\0\2\0\0\0", 13),
          "binary_little_endian");
  ASSERT_TRUE(io::load_mesh(folder.file("whole.ply", whole)));
  for (std::size_t n = 0; n < whole.size(); ++n) {
    EXPECT_FALSE(io::load_mesh(folder.file("part.ply", whole.substr(0, n)))) << n << " bytes";
  }
}

}  // namespace
}  // namespace asperity
