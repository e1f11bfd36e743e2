// SPDX-License-Identifier: Apache-2.0
/// Embree 3.13 and 4 behind one set of names. Included by sources of this folder only.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

/// Packets are not marked as coherent: Embree 3.13.5 then never returns from some of them.
namespace lucerna::embree {

#if RTC_VERSION_MAJOR >= 4

inline constexpr RTCSceneFlags filter_flag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;
using Context = RTCRayQueryContext;

inline void intersect(RTCScene scene, RTCRayHit& ray) { rtcIntersect1(scene, &ray); }

inline void occluded(RTCScene scene, Context& context, RTCFilterFunctionN filter, RTCRay& ray) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    arguments.filter = filter;
    arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    rtcOccluded1(scene, &ray, &arguments);
}

inline void occluded(RTCScene scene, Context& context, RTCFilterFunctionN filter, const int* valid,
                     RTCRay16& rays) {
    RTCOccludedArguments arguments;
    rtcInitOccludedArguments(&arguments);
    arguments.context = &context;
    arguments.filter = filter;
    arguments.flags = RTC_RAY_QUERY_FLAG_INVOKE_ARGUMENT_FILTER;
    rtcOccluded16(valid, scene, &rays, &arguments);
}

inline void init(Context& context) { rtcInitRayQueryContext(&context); }

#else

inline constexpr RTCSceneFlags filter_flag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;
using Context = RTCIntersectContext;

inline void intersect(RTCScene scene, RTCRayHit& ray) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene, &context, &ray);
}

inline void occluded(RTCScene scene, Context& context, RTCFilterFunctionN filter, RTCRay& ray) {
    context.filter = filter;
    rtcOccluded1(scene, &context, &ray);
}

inline void occluded(RTCScene scene, Context& context, RTCFilterFunctionN filter, const int* valid,
                     RTCRay16& rays) {
    context.filter = filter;
    rtcOccluded16(valid, scene, &context, &rays);
}

inline void init(Context& context) { rtcInitIntersectContext(&context); }

#endif

}  // namespace lucerna::embree
