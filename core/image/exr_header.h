// SPDX-License-Identifier: Apache-2.0
/// A look at the header of an EXR file before OpenEXR sees it.
#pragma once

#include <cstdint>
#include <span>

namespace lucerna {

/// OpenEXR 3.1 makes room for what an attribute claims to hold before it reads it, and reads
/// attributes of known types without regard to the size that they claim: a header of a few bytes
/// can ask for gigabytes. Throws FileError, without the file's name, unless every attribute has the
/// size of its type and ends within the file. Returns the number of headers: one for each part.
int check_exr_header(std::span<const std::uint8_t> bytes);

}  // namespace lucerna
