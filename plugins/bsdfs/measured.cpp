// SPDX-License-Identifier: Apache-2.0
/// measured: a material that was measured, from a file of the RGL material database (`.bsdf`).
///
/// What a file holds and how directions are drawn is in measured_material.h. The direction that the
/// file calls incident is the given one, as in Mitsuba; measurements are not exactly reciprocal, so
/// particles see the adjoint.
#include "core/base/file_bytes.h"
#include "core/interfaces/bsdf.h"
#include "plugins/bsdfs/draw.h"
#include "plugins/bsdfs/measured_material.h"

namespace lucerna {
namespace {

class Measured final : public BSDF {
public:
    explicit Measured(const Params& params) {
        const std::filesystem::path path =
            params.file("filename", "a material of the RGL database (.bsdf)");
        if (path.empty()) return;
        material_.emplace(read_file_bytes(path), path.filename().string());
        measure_albedo();
    }

    Lobe lobes() const override { return Lobe::glossy_reflection; }

    BSDFValue evaluate(const Interaction&, Vector3 wo, Vector3 wi,
                       TransportMode mode) const override {
        if (!(wo.z > 0 && wi.z > 0)) return {};
        const MeasuredMaterial::Value value = material_->evaluate(wo, wi);
        if (!(value.pdf > 0)) return {};
        const Color f = mode == TransportMode::radiance ? value.f_cos / wi.z
                                                        : material_->evaluate(wi, wo).f_cos / wo.z;
        return {f, static_cast<float>(value.pdf)};
    }

    std::optional<BSDFSample> sample(const Interaction& at, Vector3 wo, float, Vector2 u,
                                     TransportMode mode) const override {
        if (!(wo.z > 0)) return {};
        const Vector3 wi = material_->sample(wo, u);
        return drawn(*this, at, wo, glm::normalize(wi), mode, Lobe::glossy_reflection);
    }

    Color albedo(const Interaction&, Vector3 wo) const override {
        if (!(wo.z > 0)) return Color(0);
        ColorD sum(0);
        const TableMix mix = material_->mix(wo);
        for (std::size_t i = 0; i < mix.count; ++i) sum += mix.weight[i] * albedo_[mix.table[i]];
        return Color(sum);
    }

private:
    /// For each direction of the file, from a grid of samples.
    void measure_albedo() {
        constexpr int side = 16;
        for (std::size_t k = 0; k < material_->direction_count(); ++k) {
            Vector3 wo = material_->direction(k);
            wo.z = std::max(wo.z, 1e-3f);
            wo = glm::normalize(wo);
            ColorD sum(0);
            for (int i = 0; i < side * side; ++i) {
                const Vector2 u((static_cast<float>(i % side) + 0.5f) / side,
                                (static_cast<float>(i / side) + 0.5f) / side);
                const auto s = sample({}, wo, 0, u, TransportMode::radiance);
                if (s) sum += ColorD(s->weight);
            }
            albedo_.push_back(glm::min(sum / static_cast<double>(side * side), ColorD(1)));
        }
    }

    std::optional<MeasuredMaterial> material_;
    std::vector<ColorD> albedo_;
};

}  // namespace

const PluginInfo plugin = describe<Measured>("a material that was measured, from a file");

}  // namespace lucerna
