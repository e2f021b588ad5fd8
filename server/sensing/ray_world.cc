#include "server/sensing/ray_world.h"

#include <algorithm>
#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include "server/sensing/embree.h"
#include "server/sensing/solid.h"

namespace visum::sensing {
namespace {

using Eigen::Vector3d;

constexpr const char* kDevice = "threads=1,isa=sse2,set_affinity=0";

struct Item {
  world::ShapeId id;
  const world::Shape* shape;
  Solid solid;
  world::Pose X_WS;
  bool placed = false;
  RTCGeometry geometry = nullptr;  // null: a plane, which is endless; Embree does not know it
  const world::TriangleMesh* mesh = nullptr;
};

// Carries the ray in double precision to the callbacks, and their best hit back. Embree hands the callbacks a
// pointer to the first member.
struct Query {
  RTCIntersectContext embree;
  const Ray* ray;
  const std::vector<Item>* items;
  double nearest;
  Hit hit;
};
static_assert(std::is_standard_layout_v<RTCIntersectContext>);

Query& query_of(RTCIntersectContext* context) {
  return *reinterpret_cast<Query*>(context);
}

// Finds where the ray first meets the solid's surface beyond the ray's start. True, and noted in the query,
// if that is nearer than the best hit so far.
bool meet_solid(const Item& item, Query& query) {
  const Ray& ray = *query.ray;
  if (ray.blind_to.valid() && item.shape->body == ray.blind_to) return false;
  const Eigen::Quaterniond to_S = item.X_WS.q.conjugate();
  const Passage passage = pass_through(item.solid, to_S * (ray.p_W - item.X_WS.p), to_S * ray.direction_W);
  if (passage.in > passage.out) return false;
  const bool enters = passage.in > 0.0;
  const double t = enters ? passage.in : passage.out;
  if (!(t > 0.0 && t < query.nearest)) return false;
  query.nearest = t;
  query.hit = {item.id, t, item.X_WS.q * (enters ? passage.normal_in : Vector3d(-passage.normal_out))};
  return true;
}

void meet_planes(Query& query) {
  for (const Item& item : *query.items)
    if (item.geometry == nullptr) meet_solid(item, query);
}

void bounds_of_solid(const RTCBoundsFunctionArguments* args) {
  const Item& item = *static_cast<const Item*>(args->geometryUserPtr);
  const Vector3d center = (item.solid.low + item.solid.high) / 2,
                 half = (item.solid.high - item.solid.low) / 2;
  const Vector3d reach = item.X_WS.q.toRotationMatrix().cwiseAbs() * half;
  const Vector3d middle = item.X_WS * center;
  // Wider than the errors of rounding to float and of Embree's own arithmetic.
  const Vector3d margin = 1e-6 * (middle.cwiseAbs() + reach) + Vector3d::Constant(1e-9);
  const Eigen::Vector3f low = (middle - reach - margin).cast<float>();
  const Eigen::Vector3f high = (middle + reach + margin).cast<float>();
  args->bounds_o->lower_x = low.x();
  args->bounds_o->lower_y = low.y();
  args->bounds_o->lower_z = low.z();
  args->bounds_o->upper_x = high.x();
  args->bounds_o->upper_y = high.y();
  args->bounds_o->upper_z = high.z();
}

// Only single rays are cast: args->N is 1.
void intersect_solid(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  Query& query = query_of(args->context);
  auto& found = *reinterpret_cast<RTCRayHit*>(args->rayhit);
  query.nearest = std::min(query.nearest, static_cast<double>(found.ray.tfar));  // perhaps a mesh was nearer
  if (!meet_solid(*static_cast<const Item*>(args->geometryUserPtr), query)) return;
  found.ray.tfar = static_cast<float>(query.nearest);
  found.hit.geomID = args->geomID;
  found.hit.primID = args->primID;
  found.hit.instID[0] = args->context->instID[0];
}

void occlude_solid(const RTCOccludedFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  if (!meet_solid(*static_cast<const Item*>(args->geometryUserPtr), query_of(args->context))) return;
  reinterpret_cast<RTCRay*>(args->ray)->tfar = -std::numeric_limits<float>::infinity();
}

// Lets the ray pass through the triangles of the body that it is blind to.
void filter_mesh(const RTCFilterFunctionNArguments* args) {
  const Query& query = query_of(args->context);
  const Item& item = (*query.items)[args->context->instID[0]];
  if (query.ray->blind_to.valid() && item.shape->body == query.ray->blind_to) args->valid[0] = 0;
}

// Where the ray's line meets the triangle's plane, in double precision. `about`: Embree's own distance, which
// is the answer where line and plane are nearly parallel.
Hit meet_triangle(const Item& item, unsigned triangle, const Ray& ray, double about) {
  const auto& corners = item.mesh->triangles[triangle];
  const auto corner = [&](std::size_t i) { return item.X_WS * item.mesh->vertices[corners[i]]; };
  const Vector3d a = corner(0);
  Vector3d normal = (corner(1) - a).cross(corner(2) - a).normalized();
  const double speed = normal.dot(ray.direction_W);
  if (speed > 0.0) normal = -normal;
  const double t = normal.dot(a - ray.p_W) / normal.dot(ray.direction_W);
  return {item.id, t > 0.0 && t <= ray.length_m ? t : about, normal};
}

RTCRay embree_ray(const Ray& ray, double length) {
  RTCRay r{};
  r.org_x = static_cast<float>(ray.p_W.x());
  r.org_y = static_cast<float>(ray.p_W.y());
  r.org_z = static_cast<float>(ray.p_W.z());
  r.dir_x = static_cast<float>(ray.direction_W.x());
  r.dir_y = static_cast<float>(ray.direction_W.y());
  r.dir_z = static_cast<float>(ray.direction_W.z());
  r.tnear = 0.0f;
  r.tfar = static_cast<float>(length);
  r.mask = ~0u;
  return r;
}

bool is_visible(const world::Shape& shape) {
  return shape.color[3] > 0.0;
}

}  // namespace

struct RayWorld::Impl {
  explicit Impl(const world::WorldModel& the_model) : model(the_model) {
    device = rtc.NewDevice(kDevice);
    if (device == nullptr) throw std::runtime_error("the ray tracer (Embree) does not start");
    scene = rtc.NewScene(device);
    rtc.SetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST | RTC_SCENE_FLAG_DYNAMIC);
    rtc.SetSceneBuildQuality(scene, RTC_BUILD_QUALITY_LOW);
    add_meshes();
    add_items();
    rtc.CommitScene(scene);  // now, since place() commits only where something moves
  }
  ~Impl() {
    rtc.ReleaseScene(scene);
    for (RTCScene mesh : meshes) rtc.ReleaseScene(mesh);
    rtc.ReleaseDevice(device);
  }

  void add_meshes();
  void add_items();
  Solid solid_of(const world::Shape& shape) const;
  void add_geometry(Item& item);
  void move(Item& item, const world::Pose& X_WS);
  Query query_for(const Ray& ray) const;

  const world::WorldModel& model;
  const Embree& rtc = embree();
  RTCDevice device;
  RTCScene scene;
  std::vector<RTCScene> meshes;                 // by MeshId
  std::map<world::MeshId, const Solid*> hulls;  // in items: shapes of the same mesh share one hull
  std::vector<Item> items;                      // their geometries have their indices
};

void RayWorld::Impl::add_meshes() {
  for (const world::TriangleMesh& mesh : model.meshes) {
    const RTCScene part = rtc.NewScene(device);
    rtc.SetSceneFlags(part, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtc.NewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* points = static_cast<float*>(rtc.SetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    for (const Vector3d& vertex : mesh.vertices)
      for (int axis = 0; axis < 3; ++axis) *points++ = static_cast<float>(vertex[axis]);
    auto* corners = static_cast<unsigned*>(rtc.SetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
    for (const auto& triangle : mesh.triangles)
      for (const std::uint32_t corner : triangle) *corners++ = corner;
    rtc.SetGeometryIntersectFilterFunction(geometry, filter_mesh);
    rtc.SetGeometryOccludedFilterFunction(geometry, filter_mesh);
    rtc.CommitGeometry(geometry);
    rtc.AttachGeometry(part, geometry);
    rtc.ReleaseGeometry(geometry);
    rtc.CommitScene(part);
    meshes.push_back(part);
  }
}

void RayWorld::Impl::add_items() {
  items.reserve(model.shapes.size());  // Embree keeps their addresses
  for (std::size_t i = 0; i < model.shapes.size(); ++i) {
    const world::Shape& shape = model.shapes[i];
    if (!is_visible(shape)) continue;
    items.push_back({{static_cast<std::int32_t>(i)}, &shape, solid_of(shape)});
    if (shape.kind == world::ShapeKind::kConvex) hulls.try_emplace(shape.mesh, &items.back().solid);
    if (shape.kind != world::ShapeKind::kPlane) add_geometry(items.back());
  }
}

Solid RayWorld::Impl::solid_of(const world::Shape& shape) const {
  if (shape.kind == world::ShapeKind::kConvex)
    if (const auto known = hulls.find(shape.mesh); known != hulls.end()) return *known->second;
  return make_solid(model, shape);
}

void RayWorld::Impl::add_geometry(Item& item) {
  if (item.shape->kind == world::ShapeKind::kMesh) {
    item.mesh = &model.meshes[item.shape->mesh.index()];
    item.geometry = rtc.NewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtc.SetGeometryInstancedScene(item.geometry, meshes[item.shape->mesh.index()]);
  } else {
    item.geometry = rtc.NewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtc.SetGeometryUserPrimitiveCount(item.geometry, 1);
    rtc.SetGeometryUserData(item.geometry, &item);
    rtc.SetGeometryBoundsFunction(item.geometry, bounds_of_solid, nullptr);
    rtc.SetGeometryIntersectFunction(item.geometry, intersect_solid);
    rtc.SetGeometryOccludedFunction(item.geometry, occlude_solid);
  }
  rtc.AttachGeometryByID(scene, item.geometry, static_cast<unsigned>(items.size() - 1));
  rtc.ReleaseGeometry(item.geometry);  // the scene keeps it
}

void RayWorld::Impl::move(Item& item, const world::Pose& X_WS) {
  item.X_WS = X_WS;
  item.placed = true;
  if (item.geometry == nullptr) return;
  if (item.mesh != nullptr) {
    Eigen::Matrix<float, 3, 4> X;
    X << X_WS.q.toRotationMatrix().cast<float>(), X_WS.p.cast<float>();
    rtc.SetGeometryTransform(item.geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, X.data());
  }
  rtc.CommitGeometry(item.geometry);
}

Query RayWorld::Impl::query_for(const Ray& ray) const {
  Query query{{}, &ray, &items, ray.length_m, {}};
  rtcInitIntersectContext(&query.embree);
  return query;
}

RayWorld::RayWorld(const world::WorldModel& model) : impl_(std::make_unique<Impl>(model)) {}
RayWorld::~RayWorld() = default;

void RayWorld::place(const world::WorldState& state) {
  bool moved = false;
  for (Item& item : impl_->items) {
    const std::size_t body = item.shape->body.index();
    const world::Pose X_WS =
        world::link_pose(impl_->model.bodies[body], state.bodies[body]) * item.shape->X_BS;
    if (item.placed && X_WS.p == item.X_WS.p && X_WS.q.coeffs() == item.X_WS.q.coeffs()) continue;
    impl_->move(item, X_WS);
    moved = true;
  }
  if (moved) impl_->rtc.CommitScene(impl_->scene);
}

Hit RayWorld::cast(const Ray& ray) const {
  Query query = impl_->query_for(ray);
  meet_planes(query);
  RTCRayHit found{};
  found.ray = embree_ray(ray, query.nearest);
  found.hit.geomID = found.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  impl_->rtc.Intersect1(impl_->scene, &query.embree, &found);
  if (found.hit.geomID == RTC_INVALID_GEOMETRY_ID || found.hit.instID[0] == RTC_INVALID_GEOMETRY_ID)
    return query.hit;
  return meet_triangle(impl_->items[found.hit.instID[0]], found.hit.primID, ray,
                       static_cast<double>(found.ray.tfar));
}

bool RayWorld::blocked(const Ray& ray) const {
  Query query = impl_->query_for(ray);
  meet_planes(query);
  if (query.hit.shape.valid()) return true;
  RTCRay probe = embree_ray(ray, ray.length_m);
  impl_->rtc.Occluded1(impl_->scene, &query.embree, &probe);
  return probe.tfar < 0.0f;
}

}  // namespace visum::sensing
