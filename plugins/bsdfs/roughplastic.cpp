// SPDX-License-Identifier: Apache-2.0
/// roughplastic: a matte base below a rough transparent coat (plugins/bsdfs/plastic.h).
///
/// The coat's lobe is that of `roughdielectric`. Light that facets do not reflect at once counts
/// as transmitted: it goes to the base instead of being lost.
#include "plugins/bsdfs/plastic.h"
#include "plugins/bsdfs/roughness.h"

namespace lucerna {
namespace {

class RoughPlastic final : public PlasticBSDF {
public:
    explicit RoughPlastic(const Params& params) : PlasticBSDF(params, facets(params)) {}

private:
    static Microfacet facets(const Params& params) {
        const Microfacet::Type type = distribution_type(params);
        const float alpha = params.real("alpha", 0.1, non_negative,
                                        "roughness: width of the distribution of slopes");
        return {type, alpha, alpha};
    }
};

}  // namespace

const PluginInfo plugin = describe<RoughPlastic>("a matte base below a rough transparent coat");

}  // namespace lucerna
