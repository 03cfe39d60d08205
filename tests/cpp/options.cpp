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
  options.threads = 3;
  options.output = mc::Output::new_only;
  options.progress = [](double, const char*) {};
  mc::MeshView<double> mesh;
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
  CHECK(c.progress != nullptr && c.progress_user != nullptr);
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
