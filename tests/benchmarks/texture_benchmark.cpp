// SPDX-License-Identifier: Apache-2.0
/// Processor nanoseconds of a lookup in a bitmap of 8 bits: at random places, and along rows.
#include "core/image/png.h"
#include "core/interfaces/texture.h"
#include "core/math/sequences.h"
#include "core/render/statistics.h"
#include "tests/plugins/workshop.h"

#include <fmt/format.h>

#include <functional>

namespace lucerna {

namespace {

constexpr int lookups = 1 << 22;

double nanoseconds_per_lookup(const Texture& texture, const std::function<Vector2(int)>& place) {
    std::vector<Vector2> places;
    for (int i = 0; i < lookups; ++i) places.push_back(place(i));
    Color sum(0);
    const double start = cpu_seconds();
    for (const Vector2 uv : places) sum += texture.color(uv);
    const double seconds = cpu_seconds() - start;
    if (!is_finite(sum)) fmt::print("the sum is not finite\n");  // so that it is calculated
    return seconds * 1e9 / lookups;
}

void measure(int side, const std::string& wrap_mode) {
    const TemporaryFolder folder;
    Image8 picture{.width = side, .height = side};
    Rng rng(1);
    for (int i = 0; i < 3 * side * side; ++i) {
        picture.pixels.push_back(static_cast<std::uint8_t>(256 * rng.next_float()));
    }
    write_png(folder / "noise.png", picture);
    Workshop workshop{folder.path()};
    const auto& texture =
        workshop.make<Texture>("<texture type='bitmap'>" + word("filename", "noise.png") +
                               word("wrap_mode", wrap_mode) + "</texture>");
    const auto anywhere = [&](int) { return rng.next_float2(); };
    const auto in_rows = [&](int i) {
        return Vector2(static_cast<float>(i % 4096) / 4096, static_cast<float>(i / 4096) / 1024);
    };
    fmt::print("{:>5}² {:<7}  random {:5.1f} ns   rows {:5.1f} ns\n", side, wrap_mode,
               nanoseconds_per_lookup(texture, anywhere), nanoseconds_per_lookup(texture, in_rows));
}

}  // namespace

}  // namespace lucerna

int main() {
    for (const int side : {64, 1024, 4096}) {
        for (const char* wrap_mode : {"repeat", "mirror", "clamp"})
            lucerna::measure(side, wrap_mode);
    }
}
