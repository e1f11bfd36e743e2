// SPDX-License-Identifier: Apache-2.0
/// What a plugin library exports: one constant.
///
///     const PluginInfo plugin = describe<Mirror>("a perfectly smooth mirror");
///
/// The file name is the plugin's name; the kind comes from the interface. Loading runs no code of
/// the plugin: the registry compares `abi` and `kind` before it calls anything.
#pragma once

#include "core/plugin/abi.h"
#include "core/plugin/object.h"
#include "core/plugin/params.h"

#include <concepts>
#include <cstdint>
#include <type_traits>

namespace lucerna {

/// A class that a library can export: it implements an interface completely, and is made of Params.
template <typename T>
concept Plugin = std::derived_from<T, Object> && std::constructible_from<T, const Params&> &&
                 !std::is_abstract_v<T> &&
                 requires {
    { T::kind } -> std::convertible_to<const char*>;
};

/// Plain data with C linkage, so that a foreign or stale library can be refused before any C++
/// of it runs.
struct PluginInfo {
    std::uint64_t magic;
    std::uint32_t size;  ///< of this struct
    const char* abi;     ///< lucerna_contract_abi of the headers that the plugin was compiled with
    const char* kind;    ///< "bsdf": the interface that it implements
    const char* summary;
    Object* (*create)(const Params& params);
};

inline constexpr std::uint64_t plugin_magic = 0x616e7265'63756c00;

extern "C" __attribute__((visibility("default"))) const PluginInfo plugin;

/// The description of plugin class T; `summary` is one sentence for `lucerna plugins`.
template <Plugin T>
constexpr PluginInfo describe(const char* summary) {
    return {.magic = plugin_magic,
            .size = sizeof(PluginInfo),
            .abi = lucerna_contract_abi,
            .kind = T::kind,
            .summary = summary,
            .create = [](const Params& params) -> Object* {
                T* const object = new T(params);
                if constexpr (requires { typename T::Batch; }) T::Batch::attach(*object);
                return object;
            }};
}

}  // namespace lucerna
