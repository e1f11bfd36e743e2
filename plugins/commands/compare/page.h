// SPDX-License-Identifier: Apache-2.0
/// A comparison as a page: one HTML file with everything in it. The page is
/// the folder report beside this file, put together when Lucerna is built; here its data are added.
#pragma once

#include "core/base/json.h"
#include "plugins/commands/compare/comparison.h"

#include <string>

namespace lucerna {

std::string to_html(const ComparisonResult& result, const Json& report);

}  // namespace lucerna
