// SPDX-License-Identifier: Apache-2.0
/// homogeneous: a medium that is the same everywhere, such as fog or coloured glass.
#include "plugins/media/coefficients.h"

namespace lucerna {
namespace {

class Homogeneous final : public Medium {
public:
    explicit Homogeneous(const Params& params) : Medium(params) {
        const MediumCoefficients coefficients(params);
        if (coefficients.resolution() != glm::ivec3(1)) {
            throw Error(
                "a homogeneous medium takes volumes of one value; \"heterogeneous\" varies");
        }
        if (!phase().uniform()) {
            throw Error(
                "the phase function of a homogeneous medium must be the same everywhere, since "
                "extinction depends on it; \"heterogeneous\" varies");
        }
        emits_ = coefficients.emits();
        point_ = coefficients.at(Vector3(0));
    }

    bool emits() const override { return emits_; }

private:
    MediumPoint coefficients(Vector3) const override { return point_; }

    MediumPoint point_;
    bool emits_;
};

}  // namespace

const PluginInfo plugin = describe<Homogeneous>("the same everywhere: fog, coloured glass");

}  // namespace lucerna
