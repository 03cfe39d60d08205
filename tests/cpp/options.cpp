// Every option arrives at the C call.
#include <string>

#include "suite.hpp"

namespace {

// Field by field, so that padding does not count.
void check_defaults() {
  const mc::Options options;
  mc::detail::Call call(options, mc::MeshView<float>{});
  const complete_mesh_options& got = *call.options();
  complete_mesh_options c;
  complete_mesh_options_init(&c, sizeof c);
  CHECK(got.struct_size == c.struct_size && got.vertex_type == c.vertex_type);
  CHECK(got.vertex_stride == c.vertex_stride && got.face_stride == c.face_stride);
  CHECK(got.method == c.method && got.fairing == c.fairing && got.sizing == c.sizing);
  CHECK(got.grouping == c.grouping && got.sizing_value == c.sizing_value);
  CHECK(got.selection == c.selection && got.skip_unsafe == c.skip_unsafe);
  CHECK(got.selection_ids == c.selection_ids && got.selection_count == c.selection_count);
  CHECK(got.selection_max_edges == c.selection_max_edges);
  CHECK(got.selection_length == c.selection_length);
  CHECK(std::memcmp(got.selection_point, c.selection_point, sizeof c.selection_point) == 0);
  CHECK(got.join_vertices == c.join_vertices && got.join_sizes == c.join_sizes);
  CHECK(got.join_count == c.join_count && got.threads == c.threads && got.output == c.output);
  CHECK(got.progress == c.progress && got.progress_user == c.progress_user);
  CHECK(got.source_faces == c.source_faces && got.exemplar_vertices == c.exemplar_vertices);
  CHECK(got.exemplar_vertex_count == c.exemplar_vertex_count && got.exemplar_faces == c.exemplar_faces);
  CHECK(got.exemplar_face_count == c.exemplar_face_count && got.exemplar_only == c.exemplar_only);
  CHECK(got.unmirrored == c.unmirrored && got.initial_vertices == c.initial_vertices);
  CHECK(got.initial_vertex_count == c.initial_vertex_count && got.initial_faces == c.initial_faces);
  CHECK(got.initial_face_count == c.initial_face_count);
  CHECK(got.vertex_values == c.vertex_values && got.exemplar_values == c.exemplar_values);
  CHECK(got.clean == c.clean && got.clean_rounds == c.clean_rounds);
  CHECK(got.value_channels == c.value_channels && got.steering_channels == c.steering_channels);
}

void check_all_fields() {
  mc::Options options;
  options.method = mc::Method::harary;
  options.fairing = mc::Fairing::smoothed_plate;
  options.sizing = mc::Sizing::edge_length;
  options.sizing_value = 0.25;
  options.grouping = mc::Grouping::join;
  options.join_vertices = {{1, 2, 3}, {}, {4, 5}};
  options.selection = mc::Selection::near_vertices;
  options.selection_ids = {8, 9};
  options.selection_max_edges = 17;
  options.selection_length = 2.5;
  options.selection_point = {1, 2, 3};
  options.skip_unsafe = true;
  options.clean = 5;
  options.threads = 3;
  options.output = mc::Output::new_only;
  options.progress = [](double, const char*) {};
  options.source_faces = {1, 0, 1};
  options.exemplar = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9.1}}, {{0, 1, 2}, {2, 1, 0}}};
  options.exemplar_only = true;
  options.unmirrored = true;
  options.initial = {{{0.1, 0, 0}}, {{3, 4, 5}}};
  options.vertex_values = {0.5, 1.5, 2.5, 3.5};
  options.exemplar_values = {9, 8, 7, 6, 5, 4};
  options.value_channels = 2;
  options.steering_channels = 1;
  mc::MeshView<double> mesh;
  mesh.vertex_count = 2;
  mesh.face_count = 3;
  mesh.vertex_stride = 40;
  mesh.face_stride = 16;
  mc::detail::Call call(options, mesh);
  const complete_mesh_options& c = *call.options();
  const std::uint32_t joined[] = {1, 2, 3, 4, 5}, sizes[] = {3, 0, 2}, ids[] = {8, 9};
  CHECK(c.vertex_type == COMPLETE_MESH_VERTEX_TYPE_F64 && c.vertex_stride == 40 && c.face_stride == 16);
  CHECK(c.method == COMPLETE_MESH_METHOD_HARARY && c.fairing == COMPLETE_MESH_FAIRING_SMOOTHED_PLATE);
  CHECK(c.sizing == COMPLETE_MESH_SIZING_EDGE_LENGTH && c.sizing_value == 0.25);
  CHECK(c.grouping == COMPLETE_MESH_GROUPING_JOIN && c.join_count == 3);
  CHECK(std::memcmp(c.join_vertices, joined, sizeof joined) == 0);
  CHECK(std::memcmp(c.join_sizes, sizes, sizeof sizes) == 0);
  CHECK(c.selection == COMPLETE_MESH_SELECTION_NEAR_VERTICES && c.selection_count == 2);
  CHECK(std::memcmp(c.selection_ids, ids, sizeof ids) == 0);
  CHECK(c.selection_max_edges == 17 && c.selection_length == 2.5);
  CHECK(c.selection_point[0] == 1 && c.selection_point[1] == 2 && c.selection_point[2] == 3);
  CHECK(c.skip_unsafe == 1 && c.threads == 3 && c.output == COMPLETE_MESH_OUTPUT_NEW_ONLY);
  CHECK(c.clean == 1 && c.clean_rounds == 5);
  CHECK(c.progress != nullptr && c.progress_user != nullptr);
  const double corners[] = {1, 2, 3, 4, 5, 6, 7, 8, 9.1}, added[] = {0.1, 0, 0};
  const std::uint32_t triangles[] = {0, 1, 2, 2, 1, 0}, more[] = {3, 4, 5};
  CHECK(c.source_faces[0] == 1 && c.source_faces[1] == 0 && c.source_faces[2] == 1);
  CHECK(c.exemplar_vertex_count == 3 && c.exemplar_face_count == 2);
  CHECK(std::memcmp(c.exemplar_vertices, corners, sizeof corners) == 0);
  CHECK(std::memcmp(c.exemplar_faces, triangles, sizeof triangles) == 0);
  CHECK(c.exemplar_only == 1 && c.unmirrored == 1);
  CHECK(c.initial_vertex_count == 1 && c.initial_face_count == 1);
  CHECK(std::memcmp(c.initial_vertices, added, sizeof added) == 0);
  CHECK(std::memcmp(c.initial_faces, more, sizeof more) == 0);
  CHECK(c.vertex_values[3] == 3.5 && c.exemplar_values[0] == 9 && c.exemplar_values[5] == 4);
  CHECK(c.value_channels == 2 && c.steering_channels == 1 && !call.refused());
  // A list that does not fit would be read beyond its end.
  mesh.vertex_count = 3;
  mc::detail::Call wrong(options, mesh);
  CHECK(wrong.refused() && wrong.refused()->status == mc::Status::invalid_argument);
  // rounded as a mesh of floats is
  mc::MeshView<float> floats;
  floats.face_count = 3;
  mc::detail::Call single(options, floats);
  const float rounded[] = {0.1f, 0, 0};
  CHECK(std::memcmp(single.options()->initial_vertices, rounded, sizeof rounded) == 0);
  CHECK(static_cast<const float*>(single.options()->exemplar_vertices)[8] == 9.1f);
}

// One of each kind seen in the result.
void check_effects() {
  const Ball<float> ball = make_ball_of<float>();
  const auto mesh = mc::view(ball.vertices, ball.faces);
  mc::Options options;
  options.method = mc::Method::smooth;
  const auto all = mc::complete(mesh, options);
  options.selection = mc::Selection::max_edges;
  options.selection_max_edges = PATCH_EDGES;
  const auto small = mc::complete(mesh, options);
  CHECK(all.filled_count() == 2 && small.filled_count() == 1);
  CHECK(small.holes()[small.holes()[0].status == mc::HoleStatus::filled ? 0 : 1].edge_count == PATCH_EDGES);
  options.selection = mc::Selection::near_vertices;
  options.selection_ids = {0};  // on the cap's rim
  options.output = mc::Output::new_only;
  const auto cap = mc::complete(mesh, options);
  CHECK(cap.vertices().empty() && cap.faces().empty() && cap.vertices().data() == nullptr);
  CHECK(cap.filled_count() == 1 && !cap.new_vertices().empty());
  std::size_t low = 0;
  for (const auto& p : cap.new_vertices()) low += !(p[2] > 0.8f);
  CHECK(low == 0);
  options.sizing = mc::Sizing::none;
  CHECK(mc::complete(mesh, options).new_vertices().size() < cap.new_vertices().size() / 2);
  const auto holes = mc::list_holes(mesh, options);
  CHECK(holes.size() == 2);
  CHECK((holes[0].status == mc::HoleStatus::open) != (holes[1].status == mc::HoleStatus::open));
  CHECK((holes[0].status == mc::HoleStatus::not_selected) != (holes[1].status == mc::HoleStatus::not_selected));
  // an enum's number and nothing else
  options.method = static_cast<mc::Method>(77);
  CHECK(mc::try_complete(mesh, options).status() == mc::Status::invalid_argument);
}

}  // namespace

void test_options() {
  check_defaults();
  check_all_fields();
  check_effects();
#if __cplusplus >= 202002L
  const mc::Options designated{.method = mc::Method::smooth, .threads = 2};
  CHECK(designated.method == mc::Method::smooth && designated.threads == 2);
  CHECK(designated.sizing_value == 1);
#endif
}
