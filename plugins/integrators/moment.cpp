// SPDX-License-Identifier: Apache-2.0
/// moment: the mean and the second moment of what nested integrators estimate, for the variance of
/// their samples.
///
/// For an integrator "a" the layers are those it has itself, "a.…", its picture as CIE XYZ, "a.X",
/// "a.Y", "a.Z", and after the layers of all integrators the means of their squares, "m2_a.X" and
/// so on, as in Mitsuba. The picture itself is that of the first. Pixels share no paths, so that
/// the variance m2 − mean² is that of single paths. All integrators get the same random numbers.
#include "core/render/sampling_integrator.h"
#include "core/scene/scene.h"
#include "plugins/integrators/render_options.h"

#include <string_view>

namespace lucerna {

namespace {

/// CIE XYZ of linear Rec. 709 (ITU-R BT.709).
Color xyz(Color c) {
    return {0.412391f * c.x + 0.357584f * c.y + 0.180481f * c.z, luminance(c),
            0.019331f * c.x + 0.119195f * c.y + 0.950532f * c.z};
}

class MomentIntegrator final : public SamplingIntegrator {
public:
    explicit MomentIntegrator(const Params& params) {
        accept_render_options(params);
        params.no_effect("hide_emitters", "that of the nested integrators counts");
        const std::vector<std::string> names = params.child_names(Integrator::kind);
        for (const Integrator* nested :
             params.all_nested<Integrator>({.min = 1}, "what is measured")) {
            const std::size_t i = integrators_.size();
            const std::string given = i < names.size() ? names[i] : "";
            const std::string name = given.empty() ? "_arg_" + std::to_string(i) : given;
            const auto* sampling = dynamic_cast<const SamplingIntegrator*>(nested);
            if (!sampling) {
                throw Error("each integrator in \"moment\" must trace paths from the camera; \"" +
                            name + "\" does not");
            }
            integrators_.push_back({name, sampling});
        }
    }

    bool renders_media() const override {
        return std::any_of(integrators_.begin(), integrators_.end(),
                           [](const Measured& m) { return m.integrator->renders_media(); });
    }
    int light_bounces() const override {
        int most = -1;
        for (const Measured& m : integrators_) most = std::max(most, m.integrator->light_bounces());
        return most;
    }

    std::vector<std::string> layers() const override {
        std::vector<std::string> names;
        for (const Measured& m : integrators_) {
            for (const std::string& layer : m.integrator->layers()) {
                names.push_back(m.name + "." + layer);
            }
            for (const char* channel : {".X", ".Y", ".Z"}) names.push_back(m.name + channel);
        }
        const std::size_t count = names.size();
        for (std::size_t i = 0; i < count; ++i) names.push_back("m2_" + names[i]);
        return names;
    }

    void prepare(const Scene&) override {
        for (Measured& m : integrators_) m.layer_count = m.integrator->layers().size();
    }

    void sample(const Scene& scene, std::span<CameraSample> samples) const override {
        std::size_t first = 0;
        for (const Measured& m : integrators_) {
            measure(scene, m, first, samples);
            first += m.layer_count + 3;
        }
        for (CameraSample& s : samples) {
            const std::span<float> layers = s.result.layers;
            for (std::size_t i = 0; i < first; ++i) layers[first + i] = sqr(layers[i]);
        }
    }

private:
    struct Measured {
        std::string name;
        const SamplingIntegrator* integrator;
        std::size_t layer_count = 0;
    };

    /// Fills the layers of one integrator, from `first`.
    static void measure(const Scene& scene, const Measured& m, std::size_t first,
                        std::span<CameraSample> samples) {
        std::vector<CameraSample> own(samples.begin(), samples.end());
        for (std::size_t i = 0; i < own.size(); ++i) {
            own[i].result =
                PixelSample{.layers = own[i].result.layers.subspan(first, m.layer_count),
                            .pixel = own[i].result.pixel};
            own[i].block = static_cast<std::uint32_t>(i);
        }
        m.integrator->sample(scene, own);
        for (std::size_t i = 0; i < own.size(); ++i) {
            PixelSample& result = samples[i].result;
            const Color measured = xyz(own[i].result.radiance);
            const std::span<float> picture = result.layers.subspan(first + m.layer_count, 3);
            for (int c = 0; c < 3; ++c) picture[static_cast<std::size_t>(c)] = measured[c];
            if (first > 0) continue;
            result.radiance = own[i].result.radiance;
            result.alpha = own[i].result.alpha;
        }
    }

    std::vector<Measured> integrators_;
};

}  // namespace

const PluginInfo plugin =
    describe<MomentIntegrator>("mean and second moment of what nested integrators estimate");

}  // namespace lucerna
