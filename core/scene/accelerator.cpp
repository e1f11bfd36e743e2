// SPDX-License-Identifier: Apache-2.0
#include "core/scene/accelerator.h"

#include "core/math/four_floats.h"
#include "core/scene/embree.h"

#include <fmt/format.h>

#include <atomic>
#include <map>
#include <numeric>
#include <vector>

namespace lucerna {

namespace {

/// What stands behind a geometry of Embree; its address is the geometry's user data.
struct GeometryEntry {
    const Shape* shape = nullptr;
    const std::vector<GeometryEntry>* group = nullptr;  ///< of an instance
    bool flat = false;
    bool large = false;
};

void bounds_callback(const RTCBoundsFunctionArguments* arguments) {
    const auto* entry = static_cast<const GeometryEntry*>(arguments->geometryUserPtr);
    const Bounds3 b = entry->shape->bounds();
    *arguments->bounds_o = {b.min.x, b.min.y, b.min.z, 0, b.max.x, b.max.y, b.max.z, 0};
}

Ray ray_of(const RTCRay& r) {
    return {.o = {r.org_x, r.org_y, r.org_z}, .d = {r.dir_x, r.dir_y, r.dir_z}, .tmax = r.tfar};
}

/// Analytic shapes want unit directions; shadow rays and instances do not have them.
std::optional<Hit> intersect_analytic(const GeometryEntry& entry, const RTCRay& r) {
    Ray ray = ray_of(r);
    const float length = glm::length(ray.d);
    ray.d /= length;
    ray.tmax *= length;
    std::optional<Hit> hit = entry.shape->intersect(ray);
    if (!hit) return {};
    hit->t /= length;
    if (hit->t < r.tnear || hit->t > r.tfar) return {};
    return hit;
}

void intersect_callback(const RTCIntersectFunctionNArguments* arguments) {
    if (!arguments->valid[0]) return;
    const auto* entry = static_cast<const GeometryEntry*>(arguments->geometryUserPtr);
    auto& ray = *reinterpret_cast<RTCRayHit*>(arguments->rayhit);
    const std::optional<Hit> hit = intersect_analytic(*entry, ray.ray);
    arguments->valid[0] = hit ? -1 : 0;  // Embree 4 asks whether there was a hit
    if (!hit) return;
    ray.ray.tfar = hit->t;
    ray.hit.u = hit->uv.x;
    ray.hit.v = hit->uv.y;
    ray.hit.primID = hit->primitive;
    ray.hit.geomID = arguments->geomID;
    ray.hit.instID[0] = arguments->context->instID[0];
}

RTCRay ray_of_lane(RTCRayN* rays, unsigned count, unsigned i) {
    RTCRay r;
    r.org_x = RTCRayN_org_x(rays, count, i);
    r.org_y = RTCRayN_org_y(rays, count, i);
    r.org_z = RTCRayN_org_z(rays, count, i);
    r.tnear = RTCRayN_tnear(rays, count, i);
    r.dir_x = RTCRayN_dir_x(rays, count, i);
    r.dir_y = RTCRayN_dir_y(rays, count, i);
    r.dir_z = RTCRayN_dir_z(rays, count, i);
    r.tfar = RTCRayN_tfar(rays, count, i);
    return r;
}

void occluded_callback(const RTCOccludedFunctionNArguments* arguments) {
    const auto* entry = static_cast<const GeometryEntry*>(arguments->geometryUserPtr);
    for (unsigned i = 0; i < arguments->N; ++i) {
        if (!arguments->valid[i]) continue;
        const bool hit =
            intersect_analytic(*entry, ray_of_lane(arguments->ray, arguments->N, i)).has_value();
        arguments->valid[i] = hit ? -1 : 0;
        if (hit) RTCRayN_tfar(arguments->ray, arguments->N, i) = -infinity;
    }
}

/// Curves are met from outside only.
void outside_filter(const RTCFilterFunctionNArguments* arguments) {
    const unsigned count = arguments->N;
    for (unsigned i = 0; i < count; ++i) {
        const Vector3 n(RTCHitN_Ng_x(arguments->hit, count, i),
                        RTCHitN_Ng_y(arguments->hit, count, i),
                        RTCHitN_Ng_z(arguments->hit, count, i));
        const Vector3 d(RTCRayN_dir_x(arguments->ray, count, i),
                        RTCRayN_dir_y(arguments->ray, count, i),
                        RTCRayN_dir_z(arguments->ray, count, i));
        if (glm::dot(n, d) > 0) arguments->valid[i] = 0;
    }
}

/// The context of shadow rays: the two primitives that do not block each of them.
struct ShadowContext {
    struct Ends {
        PrimitiveId source, target;
    };

    embree::Context base;        // first: Embree hands back a pointer to it
    const Ends* ends = nullptr;  ///< by the number of the ray
};

void shadow_filter(const RTCFilterFunctionNArguments* arguments) {
    const auto* context = reinterpret_cast<const ShadowContext*>(arguments->context);
    const unsigned count = arguments->N;
    for (unsigned i = 0; i < count; ++i) {
        if (!arguments->valid[i]) continue;
        const PrimitiveId id{.geometry = RTCHitN_geomID(arguments->hit, count, i),
                             .primitive = RTCHitN_primID(arguments->hit, count, i),
                             .instance = RTCHitN_instID(arguments->hit, count, i, 0)};
        const ShadowContext::Ends& ends = context->ends[RTCRayN_id(arguments->ray, count, i)];
        if (id == ends.source || id == ends.target) arguments->valid[i] = 0;
    }
}

}  // namespace

struct Accelerator::Implementation {
    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::atomic<long long> bytes{0};
    std::vector<GeometryEntry> entries;
    std::map<const Shape*, std::pair<RTCScene, std::unique_ptr<std::vector<GeometryEntry>>>> groups;
    std::string build_error;

    ~Implementation() {
        for (auto& [shape, group] : groups) rtcReleaseScene(group.first);
        if (scene) rtcReleaseScene(scene);
        if (device) rtcReleaseDevice(device);
    }

    RTCScene make_scene(std::span<const Shape* const> shapes, std::vector<GeometryEntry>& list);
    RTCGeometry make_geometry(const Geometry& geometry, GeometryEntry& entry);
    RTCGeometry make_triangles(const TriangleGeometry& mesh);
    RTCGeometry make_parallelograms(std::span<const Parallelogram> list);
    RTCGeometry make_curves(const CurveGeometry& curves);
    RTCGeometry make_instance(const InstanceGeometry& instance, GeometryEntry& entry);
};

RTCGeometry Accelerator::Implementation::make_triangles(const TriangleGeometry& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                               mesh.positions.first, 0, mesh.positions.stride * sizeof(float),
                               mesh.positions.count);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                               mesh.indices.data(), 0, 3 * sizeof(std::uint32_t),
                               mesh.indices.size() / 3);
    return geometry;
}

RTCGeometry Accelerator::Implementation::make_parallelograms(std::span<const Parallelogram> list) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD);
    auto* vertices = static_cast<Vector3*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vector3), 4 * list.size()));
    for (const Parallelogram& p : list) {
        *vertices++ = p.corner;
        *vertices++ = p.corner + p.edge_u;
        *vertices++ = p.corner + p.edge_u + p.edge_v;
        *vertices++ = p.corner + p.edge_v;
    }
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4,
                                4 * sizeof(std::uint32_t), list.size()));
    std::iota(indices, indices + 4 * list.size(), 0u);
    return geometry;
}

RTCGeometry Accelerator::Implementation::make_curves(const CurveGeometry& curves) {
    const bool linear = curves.basis == CurveGeometry::Basis::linear;
    RTCGeometry geometry = rtcNewGeometry(device, linear ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE
                                                         : RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT4,
                               curves.points.data(), 0, sizeof(glm::vec4), curves.points.size());
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT,
                               curves.first.data(), 0, sizeof(std::uint32_t), curves.first.size());
    rtcSetGeometryIntersectFilterFunction(geometry, outside_filter);
    rtcSetGeometryOccludedFilterFunction(geometry, outside_filter);
    if (linear) {
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR,
                                   curves.neighbours.data(), 0, 1, curves.neighbours.size());
    }
    return geometry;
}

RTCGeometry Accelerator::Implementation::make_instance(const InstanceGeometry& instance,
                                                       GeometryEntry& entry) {
    auto& [group_scene, group_entries] = groups[instance.group];
    if (!group_scene) {
        const Geometry shape = instance.group->geometry();
        const auto* group = std::get_if<GroupGeometry>(&shape);
        if (!group) throw Error("an instance must show a shapegroup");
        group_entries = std::make_unique<std::vector<GeometryEntry>>();
        group_scene = make_scene(group->shapes, *group_entries);
    }
    entry.group = group_entries.get();
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, group_scene);
    const Matrix4d& m = instance.world_from_group.matrix();
    float columns[12];
    for (int c = 0; c < 4; ++c) {
        for (int r = 0; r < 3; ++r) columns[3 * c + r] = static_cast<float>(m[c][r]);
    }
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
    return geometry;
}

RTCGeometry Accelerator::Implementation::make_geometry(const Geometry& shape,
                                                       GeometryEntry& entry) {
    if (const auto* mesh = std::get_if<TriangleGeometry>(&shape)) {
        entry.flat = true;
        return make_triangles(*mesh);
    }
    if (const auto* quad = std::get_if<ParallelogramGeometry>(&shape)) {
        entry.flat = true;
        return make_parallelograms(quad->list);
    }
    if (const auto* curves = std::get_if<CurveGeometry>(&shape)) return make_curves(*curves);
    if (const auto* instance = std::get_if<InstanceGeometry>(&shape)) {
        return make_instance(*instance, entry);
    }
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryBoundsFunction(geometry, bounds_callback, nullptr);
    rtcSetGeometryIntersectFunction(geometry, intersect_callback);
    rtcSetGeometryOccludedFunction(geometry, occluded_callback);
    return geometry;
}

RTCScene Accelerator::Implementation::make_scene(std::span<const Shape* const> shapes,
                                                 std::vector<GeometryEntry>& list) {
    RTCScene result = rtcNewScene(device);
    // Robust: closed meshes must not leak. It costs about a tenth of the ray rate.
    rtcSetSceneFlags(result, RTC_SCENE_FLAG_ROBUST | embree::filter_flag);
    list.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) {
        list[i].shape = shapes[i];
        const Geometry geometry = shapes[i]->geometry();
        if (std::holds_alternative<GroupGeometry>(geometry)) continue;
        list[i].large = shapes[i]->primitive_count() >= 1024;
        RTCGeometry made = make_geometry(geometry, list[i]);
        rtcSetGeometryUserData(made, &list[i]);
        rtcCommitGeometry(made);
        rtcAttachGeometryByID(result, made, static_cast<unsigned>(i));
        rtcReleaseGeometry(made);
    }
    rtcCommitScene(result);
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE || !build_error.empty()) {
        throw Error(fmt::format("Embree could not build the scene: {}", build_error));
    }
    return result;
}

Accelerator::Accelerator(std::span<Shape* const> shapes, int threads)
    : implementation_(std::make_unique<Implementation>()) {
    const std::string config = threads > 0 ? fmt::format("threads={}", threads) : "";
    implementation_->device = rtcNewDevice(config.c_str());
    if (!implementation_->device) throw Error("Embree could not be started on this processor");
    rtcSetDeviceErrorFunction(
        implementation_->device,
        [](void* user, RTCError, const char* text) {
            static_cast<Implementation*>(user)->build_error = text ? text : "unknown";
        },
        implementation_.get());
    rtcSetDeviceMemoryMonitorFunction(
        implementation_->device,
        [](void* user, ssize_t bytes, bool) {
            static_cast<Implementation*>(user)->bytes += bytes;
            return true;
        },
        implementation_.get());
    const std::vector<const Shape*> list(shapes.begin(), shapes.end());
    implementation_->scene = implementation_->make_scene(list, implementation_->entries);
}

Accelerator::~Accelerator() = default;

std::size_t Accelerator::bytes() const {
    return static_cast<std::size_t>(std::max(0LL, implementation_->bytes.load()));
}

namespace {

/// Fills the ray in the pieces in which Embree reads it: what was just written in smaller ones,
/// processors cannot forward.
void to_embree(const Ray& ray, float tmin, RTCRay& r) {
    const FourFloats origin{ray.o.x, ray.o.y, ray.o.z, tmin};
    const FourFloats direction{ray.d.x, ray.d.y, ray.d.z, 0};  // and time
    std::memcpy(&r.org_x, &origin, sizeof origin);
    std::memcpy(&r.dir_x, &direction, sizeof direction);
    r.tfar = ray.tmax;
    r.mask = 0xffffffff;
    r.id = 0;
    r.flags = 0;
}

}  // namespace

bool Accelerator::intersect(const Ray& ray, float tmin, SceneHit& met) const {
    RTCRayHit r;
    to_embree(ray, tmin, r.ray);
    r.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    r.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    embree::intersect(implementation_->scene, r);
    if (r.hit.geomID == RTC_INVALID_GEOMETRY_ID) return false;

    const bool instanced = r.hit.instID[0] != RTC_INVALID_GEOMETRY_ID;
    const GeometryEntry& outer =
        implementation_->entries[instanced ? r.hit.instID[0] : r.hit.geomID];
    const GeometryEntry& entry = instanced ? (*outer.group)[r.hit.geomID] : outer;
    met.hit = {.t = r.ray.tfar, .uv = {r.hit.u, r.hit.v}, .primitive = r.hit.primID};
    met.shape = entry.shape;
    met.instance = instanced ? outer.shape : nullptr;
    met.id = {.geometry = r.hit.geomID, .primitive = r.hit.primID, .instance = r.hit.instID[0]};
    met.flat = entry.flat;
    met.large = entry.large;
    return true;
}

bool Accelerator::occluded(const Ray& ray, PrimitiveId target) const {
    const ShadowContext::Ends ends{.source = ray.source, .target = target};
    ShadowContext context{.base = {}, .ends = &ends};
    embree::init(context.base);
    RTCRay r;
    to_embree(ray, 0, r);
    embree::occluded(implementation_->scene, context.base, shadow_filter, r);
    return r.tfar < 0;
}

void Accelerator::occluded(ShadowPacket& rays) const {
    static_assert(sizeof(FloatLanes) == sizeof(RTCRay16::org_x));
    ShadowContext::Ends ends[lane_count];
    ShadowContext context{.base = {}, .ends = ends};
    embree::init(context.base);
    alignas(64) int valid[lane_count];
    RTCRay16 r;
    std::memcpy(r.org_x, &rays.o, sizeof rays.o);
    std::memcpy(r.dir_x, &rays.d, sizeof rays.d);
    std::memcpy(r.tfar, &rays.tmax, sizeof rays.tmax);
    for (std::size_t i = 0; i < lane_count; ++i) {
        valid[i] = rays.open[i] ? -1 : 0;
        ends[i] = {.source = rays.source[i], .target = rays.target[i]};
        r.tnear[i] = r.time[i] = 0;
        r.mask[i] = 0xffffffff;
        r.id[i] = static_cast<unsigned>(i);
        r.flags[i] = 0;
    }
    embree::occluded(implementation_->scene, context.base, shadow_filter, valid, r);
    for (std::size_t i = 0; i < lane_count; ++i) rays.open[i] &= !(r.tfar[i] < 0);
}

}  // namespace lucerna
