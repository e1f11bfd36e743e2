// SPDX-License-Identifier: Apache-2.0
/// What a plugin must have been compiled against.
///
/// The text is generated into a source file of its own, which the core and every plugin link
/// (contracts.cpp.in): a changed header changes one small object, not the text of all sources.
#pragma once

namespace lucerna {

/// Version of Lucerna: "0.1.0".
extern "C" __attribute__((visibility("hidden"))) const char lucerna_version[];

/// Version, hash of the contract headers, C++ library and GLM that this library or plugin was
/// compiled with. A plugin whose text is not the core's is refused.
extern "C" __attribute__((visibility("hidden"))) const char lucerna_contract_abi[];

}  // namespace lucerna
