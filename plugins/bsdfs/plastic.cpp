// SPDX-License-Identifier: Apache-2.0
/// plastic: a matte base below a smooth transparent coat (plugins/bsdfs/plastic.h).
#include "plugins/bsdfs/plastic.h"

namespace lucerna {
namespace {

class Plastic final : public PlasticBSDF {
public:
    explicit Plastic(const Params& params) : PlasticBSDF(params, std::nullopt) {}
};

}  // namespace

const PluginInfo plugin = describe<Plastic>("a matte base below a smooth transparent coat");

}  // namespace lucerna
