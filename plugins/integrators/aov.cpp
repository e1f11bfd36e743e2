// SPDX-License-Identifier: Apache-2.0
/// aov: what the camera sees of the surfaces, as extra layers of the image.
///
/// Depth is the distance from the lens along the ray, whatever the near clip plane.
///
/// `aovs` is a list of name:kind, as in Mitsuba: "albedo:albedo,nn:sh_normal,dist:depth". It makes
/// the channels albedo.R, albedo.G, albedo.B, nn.X, …, dist.T. A nested integrator makes the image
/// itself; without one it shows the first layer.
#include "core/interfaces/bsdf.h"
#include "core/render/sampling_integrator.h"
#include "core/scene/scene.h"
#include "plugins/integrators/render_options.h"

#include <array>
#include <string_view>
#include <unordered_map>

namespace lucerna {

namespace {

enum class Aov : std::uint8_t {
    albedo,
    depth,
    position,
    uv,
    geo_normal,
    sh_normal,
    prim_index,
    shape_index
};

struct AovKind {
    std::string_view name;
    Aov aov;
    std::string_view suffixes;  ///< one letter for each channel, as in Mitsuba
};

constexpr std::array aov_kinds{
    AovKind{"albedo", Aov::albedo, "RGB"},         AovKind{"depth", Aov::depth, "T"},
    AovKind{"position", Aov::position, "XYZ"},     AovKind{"uv", Aov::uv, "UV"},
    AovKind{"geo_normal", Aov::geo_normal, "XYZ"}, AovKind{"sh_normal", Aov::sh_normal, "XYZ"},
    AovKind{"prim_index", Aov::prim_index, "I"},   AovKind{"shape_index", Aov::shape_index, "I"},
};

class AovIntegrator final : public SamplingIntegrator {
public:
    explicit AovIntegrator(const Params& params)
        : image_(params.nested<Integrator>("makes the image beside the layers")) {
        accept_render_options(params);
        params.no_effect("hide_emitters", "that of the nested integrator counts");
        std::string_view list;
        const std::string given =
            params.string("aovs", "albedo:albedo,normal:sh_normal,depth:depth,position:position",
                          "layers as name:kind,…; kinds: albedo, depth, position, uv, "
                          "geo_normal, sh_normal, prim_index, shape_index");
        for (list = given; !list.empty();) {
            const std::size_t comma = std::min(list.find(','), list.size());
            add_layer(params, list.substr(0, comma));
            list.remove_prefix(std::min(comma + 1, list.size()));
        }
        if (layers_.empty()) params.error("aovs", "aovs must name at least one layer");
        if (image_ && !dynamic_cast<const SamplingIntegrator*>(image_)) {
            params.error("aovs", "the nested integrator must trace paths from the camera");
        }
    }

    void prepare(const Scene& scene) override {
        origin_ = Vector3(scene.origin());
        image_layers_ = image_ ? image_->layers().size() : 0;
        for (const Shape* shape : scene.shapes()) {
            shape_indices_.emplace(shape, static_cast<float>(shape_indices_.size()));
        }
    }

    bool renders_media() const override { return image_ && image_->renders_media(); }
    int light_bounces() const override { return image_ ? image_->light_bounces() : -1; }
    std::vector<std::string> layers() const override {
        std::vector<std::string> names = image_ ? image_->layers() : std::vector<std::string>();
        for (const Layer& layer : layers_) {
            for (const char suffix : layer.kind->suffixes) {
                names.push_back(layer.name + "." + suffix);
            }
        }
        return names;
    }

    int block_size() const override { return image_ ? image_->block_size() : 1; }
    void sample(const Scene& scene, std::span<CameraSample> samples) const override;

private:
    struct Layer {
        std::string name;
        const AovKind* kind;
    };

    void fill_layers(const Scene& scene, CameraSample& sample) const;
    void add_layer(const Params& params, std::string_view text);
    Vector3 value(const Interaction& at, Vector3 wo, Aov aov) const;

    const Integrator* image_;
    std::vector<Layer> layers_;
    std::size_t image_layers_ = 0;
    std::unordered_map<const Shape*, float> shape_indices_;
    Vector3 origin_{0};
};

void AovIntegrator::add_layer(const Params& params, std::string_view text) {
    while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string name(text.substr(0, colon));
    const std::string wanted(text.substr(std::min(colon + 1, text.size())));
    std::vector<std::string> kinds;
    for (const AovKind& known : aov_kinds) {
        if (known.name == wanted) {
            layers_.push_back({name, &known});
            return;
        }
        kinds.emplace_back(known.name);
    }
    params.error("aovs", "there is no kind of layer \"" + wanted + "\" in \"" + std::string(text) +
                             "\"" + did_you_mean(wanted, kinds) + "\n  there are: " + join(kinds));
}

Vector3 AovIntegrator::value(const Interaction& at, Vector3 wo, Aov aov) const {
    switch (aov) {
        case Aov::albedo:
            return at.shape->bsdf()->albedo(at, at.to_local(wo));
        case Aov::depth:
            return Vector3(at.t);
        case Aov::position:
            return at.p + origin_;
        case Aov::uv:
            return {at.uv.x, at.uv.y, 0};
        case Aov::geo_normal:
            return at.n;
        case Aov::sh_normal:
            return at.shading.n;
        case Aov::prim_index:
            return Vector3(static_cast<float>(at.primitive));
        case Aov::shape_index: {
            const auto found = shape_indices_.find(at.shape);
            return Vector3(found == shape_indices_.end() ? -1.0f : found->second);
        }
    }
    return Vector3(0);
}

/// The image goes into the first layers and the result, as the nested integrator says.
void AovIntegrator::sample(const Scene& scene, std::span<CameraSample> samples) const {
    if (image_) {
        std::vector<CameraSample> image(samples.begin(), samples.end());
        for (CameraSample& s : image) s.result.layers = s.result.layers.first(image_layers_);
        static_cast<const SamplingIntegrator*>(image_)->sample(scene, image);
        for (std::size_t i = 0; i < samples.size(); ++i) {
            samples[i].result.radiance = image[i].result.radiance;
            samples[i].result.alpha = image[i].result.alpha;
        }
    }
    for (CameraSample& s : samples) fill_layers(scene, s);
}

void AovIntegrator::fill_layers(const Scene& scene, CameraSample& sample) const {
    const Ray& ray = sample.ray;
    PixelSample& result = sample.result;
    const std::span<float> layers = result.layers;
    std::size_t next = image_layers_;
    std::optional<Interaction> at = scene.intersect(ray);
    if (!at) {
        if (!image_) result.alpha = 0;
        return;
    }
    at->t += scene.sensor().distance_from_lens(ray);
    for (const Layer& layer : layers_) {
        const Vector3 v = value(*at, -ray.d, layer.kind->aov);
        if (!image_ && &layer == layers_.data()) result.radiance = v;
        for (std::size_t c = 0; c < layer.kind->suffixes.size(); ++c) {
            layers[next++] = v[static_cast<Vector3::length_type>(c)];
        }
    }
}

}  // namespace

const PluginInfo plugin = describe<AovIntegrator>("albedo, normals, depth and more as layers");

}  // namespace lucerna
