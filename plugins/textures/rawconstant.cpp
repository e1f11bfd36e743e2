// SPDX-License-Identifier: Apache-2.0
/// rawconstant: the same number, or the same three, everywhere, as they are written.
#include "core/interfaces/texture.h"

namespace lucerna {

namespace {

class RawConstant final : public Texture {
public:
    explicit RawConstant(const Params& params)
        : value_(params.numbers("value", "one number or three, in no colour space")) {}

    Color color(Vector2) const override { return value_; }
    float real(Vector2) const override { return luminance(value_); }
    Vector2 gradient(Vector2) const override { return Vector2(0); }
    Color mean() const override { return value_; }
    float max() const override { return max_component(value_); }

private:
    Vector3 value_;
};

}  // namespace

const PluginInfo plugin = describe<RawConstant>("the same numbers everywhere");

}  // namespace lucerna
