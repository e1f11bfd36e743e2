// SPDX-License-Identifier: Apache-2.0
#include "core/scene/processor_rounding.h"

#include "core/base/error.h"
#include "core/base/file_bytes.h"
#include "core/math/sequences.h"
#include "core/math/vector.h"
#include "core/scene/embree.h"

#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <vector>

namespace lucerna {

namespace {

struct Release {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using Device = std::unique_ptr<RTCDeviceTy, Release>;
using EmbreeScene = std::unique_ptr<RTCSceneTy, Release>;

/// Points of the unit cube that are the same everywhere.
class Points {
public:
    Vector3 next() {
        const std::uint32_t i = 3 * index_++;
        return {coordinate(i), coordinate(i + 1), coordinate(i + 2)};
    }

private:
    static float coordinate(std::uint32_t i) {
        return uint_to_float(static_cast<std::uint32_t>(mix64(i)));
    }

    std::uint32_t index_ = 0;
};

EmbreeScene make_scene(RTCDevice device, Points& points) {
    constexpr unsigned triangles = 64;
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), 3 * triangles));
    auto* indices = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), triangles));
    if (!vertices || !indices) throw Error("Embree has not enough memory");
    for (std::uint32_t i = 0; i < 3 * triangles; ++i) {
        const Vector3 point = points.next();
        std::memcpy(vertices + 3 * i, &point, sizeof point);
        indices[i] = i;
    }
    rtcCommitGeometry(geometry);
    EmbreeScene scene(rtcNewScene(device));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene.get());
    return scene;
}

void add_hits(Points& points, std::vector<double>& values) {
    constexpr int rays = 256;
    const Device device(rtcNewDevice("threads=1"));
    if (!device) throw Error("Embree could not be started on this processor");
    const EmbreeScene scene = make_scene(device.get(), points);
    for (int i = 0; i < rays; ++i) {
        RTCRayHit ray{};
        const Vector3 from = points.next(), direction = points.next() - from;
        std::memcpy(&ray.ray.org_x, &from, sizeof from);
        std::memcpy(&ray.ray.dir_x, &direction, sizeof direction);
        ray.ray.tfar = std::numeric_limits<float>::infinity();
        ray.ray.mask = 0xffffffff;
        ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        embree::intersect(scene.get(), ray);
        values.insert(values.end(), {ray.ray.tfar, ray.hit.u, ray.hit.v});
    }
}

void add_functions(Points& points, std::vector<double>& values) {
    constexpr int count = 1024;
    for (int i = 0; i < count; ++i) {
        const Vector3d x(8.0f * points.next());
        values.insert(values.end(), {std::sin(x.x), std::cos(x.x), std::exp(-x.y), std::log(x.y),
                                     std::pow(x.x, x.z), std::atan2(x.y, x.z), std::acos(x.x / 8)});
    }
}

std::uint64_t compute() {
    Points points;
    std::vector<double> values;
    add_hits(points, values);
    add_functions(points, values);
    return hash_of_bytes(
        {reinterpret_cast<const std::uint8_t*>(values.data()), values.size() * sizeof(double)});
}

}  // namespace

std::uint64_t processor_rounding() {
    static const std::uint64_t rounding = compute();
    return rounding;
}

}  // namespace lucerna
