// SPDX-License-Identifier: Apache-2.0
/// Any bytes, read as each kind of picture, end in an error message or in a picture.
#include "core/base/error.h"
#include "core/image/exr.h"
#include "core/image/hdr.h"
#include "core/image/jpeg.h"
#include "core/image/plain_formats.h"
#include "core/image/png.h"

#include <cstdint>
#include <span>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::span<const std::uint8_t> bytes(data, size);
    const auto attempt = [&](const auto& decode) {
        try {
            decode(bytes, "fuzz");
        } catch (const lucerna::Error&) {
            // The expected end.
        }
    };
    attempt(lucerna::decode_png);
    attempt(lucerna::decode_jpeg);
    attempt(lucerna::decode_hdr);
    attempt(lucerna::decode_exr);
    attempt(lucerna::decode_bmp);
    attempt(lucerna::decode_tga);
    attempt(lucerna::decode_portable_map);
    return 0;
}
