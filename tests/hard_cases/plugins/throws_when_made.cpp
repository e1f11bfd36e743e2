// SPDX-License-Identifier: Apache-2.0
/// A plugin whose constructor throws what it should not.
#include "core/interfaces/bsdf.h"

#include <stdexcept>

namespace lucerna {
namespace {

/// Known to nobody else.
struct PrivateError : std::logic_error {
    using std::logic_error::logic_error;
};

class Thrower final : public BSDF {
public:
    explicit Thrower(const Params& params) {
        const std::string what = params.string("what", "error", "error, private or memory");
        if (what == "error") throw Error("the plugin does not like this");
        if (what == "private") throw PrivateError("something went wrong inside");
        throw std::bad_alloc();
    }
    Lobe lobes() const override { return Lobe::none; }
    BSDFValue evaluate(const Interaction&, Vector3, Vector3, TransportMode) const override {
        return {};
    }
    std::optional<BSDFSample> sample(const Interaction&, Vector3, float, Vector2,
                                     TransportMode) const override {
        return {};
    }
    Color albedo(const Interaction&, Vector3) const override { return Color(0); }
};

}  // namespace

const PluginInfo plugin = describe<Thrower>("throws");

}  // namespace lucerna
