// SPDX-License-Identifier: Apache-2.0
#include "core/image/color.h"

#include <OpenColorIO/OpenColorIO.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <mutex>
#include <sstream>

#include "core/base/error.h"
#include "core/image/builtin_ocio.h"

namespace lucerna {

namespace ocio = OCIO_NAMESPACE;

namespace {

const std::vector<std::string> linear_names{
    "Linear Rec.709 (sRGB)",  "lin_rec709", "lin_rec709_srgb",
    "lin_rec709_scene",       "lin_srgb",   "linear",
    "Utility - Linear - sRGB"};
const std::vector<std::string> srgb_names{"sRGB - Texture", "srgb_tx", "srgb_texture",
                                          "srgb",           "sRGB",    "Utility - sRGB - Texture"};
const std::vector<std::string> raw_names{"Raw", "raw", "data", "Utility - Raw"};
constexpr std::string_view srgb_view = "sRGB - Display/Un-tone-mapped";
constexpr std::string_view raw_view = "sRGB - Display/Raw";

/// Far above any display; keeps infinities out of the arithmetic of views.
constexpr float brightest = 65504;

bool contains(const std::vector<std::string>& names, std::string_view name) {
    return std::find(names.begin(), names.end(), name) != names.end();
}

/// XYZ of the point with chromaticity xy and Y = 1.
Vector3d xyz_of(Vector2d xy) { return {xy.x / xy.y, 1.0, (1 - xy.x - xy.y) / xy.y}; }

Matrix3d xyz_from_rgb(const Chromaticities& c) {
    const Matrix3d primaries(xyz_of(c.red), xyz_of(c.green), xyz_of(c.blue));
    const Vector3d scale = glm::inverse(primaries) * xyz_of(c.white);
    return {primaries[0] * scale.x, primaries[1] * scale.y, primaries[2] * scale.z};
}

/// The library prints hints to the terminal, which belongs to the progress bar; errors are thrown.
void silence() { ocio::SetLoggingLevel(ocio::LOGGING_LEVEL_NONE); }

/// Lam's Bradford cone responses, as in ICC.1:2022, annex E; columns.
const Matrix3d bradford(0.8951, -0.7502, 0.0389, 0.2664, 1.7135, -0.0685, -0.1614, 0.0367, 1.0296);

bool is_color_triangle(const Chromaticities& c) {
    const Vector2d a = c.green - c.red, b = c.blue - c.red;
    const double area = a.x * b.y - a.y * b.x;
    return std::abs(area) > 1e-6 && c.red.y > 0 && c.green.y > 0 && c.blue.y > 0 && c.white.y > 0;
}

}  // namespace

float srgb_to_linear(float encoded) {
    const float v = std::abs(encoded);
    const float linear = v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f);
    return std::copysign(linear, encoded);
}

float linear_to_srgb(float linear) {
    const float v = std::abs(linear);
    const float encoded = v <= 0.0031308f ? v * 12.92f : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f;
    return std::copysign(encoded, linear);
}

Color srgb_to_linear(Color c) {
    return {srgb_to_linear(c.x), srgb_to_linear(c.y), srgb_to_linear(c.z)};
}

Color linear_to_srgb(Color c) {
    return {linear_to_srgb(c.x), linear_to_srgb(c.y), linear_to_srgb(c.z)};
}

float decoded(const Image& image, float value) {
    if (image.srgb_encoded) return srgb_to_linear(value);
    return image.gamma == 1 ? value : std::copysign(std::pow(std::abs(value), image.gamma), value);
}

Matrix3d rec709_from(const Chromaticities& chromaticities) {
    if (!is_color_triangle(chromaticities)) {
        throw Error("the chromaticities of the image span no triangle; name its colour space");
    }
    const Chromaticities rec709;
    const Vector3d ratio =
        (bradford * xyz_of(rec709.white)) / (bradford * xyz_of(chromaticities.white));
    Matrix3d adapt = bradford;
    for (int column = 0; column < 3; ++column) adapt[column] *= ratio;
    return glm::inverse(xyz_from_rgb(rec709)) * glm::inverse(bradford) * adapt *
           xyz_from_rgb(chromaticities);
}

struct ColorConfig::State {
    enum class Kind { builtin, none, file };

    Kind kind = Kind::builtin;
    std::string source = "built-in";
    std::string notice;
    std::string rendering_space = linear_names.front();
    mutable ocio::ConstConfigRcPtr config;
    mutable std::once_flag loaded;

    /// The configuration; the built-in one is parsed when it is first needed.
    const ocio::Config& get() const {
        std::call_once(loaded, [this] {
            if (config) return;
            silence();
            std::istringstream text(builtin_ocio);
            config = ocio::Config::CreateFromStream(text);
        });
        return *config;
    }

    void load(const std::string& path) {
        try {
            silence();
            config = ocio::Config::CreateFromFile(path.c_str());
            config->validate();
        } catch (const std::exception& error) {
            throw Error(fmt::format(
                "the colour configuration {} cannot be used: {}\n  OpenColorIO {} reads profiles "
                "up to 2.1, and no .ocioz; use an \"ocio-v2.1\" configuration, or \"builtin\"",
                path, error.what(), ocio::GetVersion()));
        }
        kind = Kind::file;
        source = path;
        rendering_space = find_rendering_space();
    }

    std::string find_rendering_space() const {
        if (config->hasRole("rendering")) return canonical("rendering");
        for (const std::string& name : linear_names) {
            if (config->getColorSpace(name.c_str())) return canonical(name);
        }
        if (config->hasRole("scene_linear")) return canonical("scene_linear");
        throw Error(fmt::format(
            "the colour configuration {} has no role \"rendering\" or \"scene_linear\"; add one",
            source));
    }

    std::string canonical(const std::string& name) const {
        return config->getColorSpace(name.c_str())->getName();
    }

    std::vector<std::string> spaces() const {
        if (kind == Kind::none) return {linear_names[0], srgb_names[0], raw_names[0]};
        std::vector<std::string> names;
        for (int i = 0; i < get().getNumColorSpaces(); ++i) {
            names.emplace_back(get().getColorSpaceNameByIndex(i));
        }
        return names;
    }

    [[noreturn]] void no_such_space(std::string_view name) const {
        const std::vector<std::string> names = spaces();
        throw Error(
            fmt::format("there is no colour space \"{}\" in the colour configuration ({}){}"
                        "\n  there are: auto, raw, {}",
                        name, source, did_you_mean(name, names), join(names)));
    }

    /// The name by which OpenColorIO knows the space, for spaces that are not handled here.
    std::string resolve(std::string_view space) const {
        const std::string name(space);
        if (kind == Kind::none || !get().getColorSpace(name.c_str())) no_such_space(space);
        return canonical(name);
    }

    std::vector<std::string> views() const {
        if (kind == Kind::none) return {std::string(srgb_view), std::string(raw_view)};
        const char* display = get().getDefaultDisplay();
        std::vector<std::string> names{
            fmt::format("{}/{}", display, get().getDefaultView(display))};
        for (int d = 0; d < get().getNumDisplays(); ++d) {
            display = get().getDisplay(d);
            for (int v = 0; v < get().getNumViews(display); ++v) {
                std::string name = fmt::format("{}/{}", display, get().getView(display, v));
                if (!contains(names, name)) names.push_back(std::move(name));
            }
        }
        return names;
    }

    /// The full name of a view that the user may have named by its second half only.
    std::string resolve_view(std::string_view view) const {
        if (kind == Kind::builtin && (view.empty() || view == srgb_view)) {
            return std::string(srgb_view);
        }
        const std::vector<std::string> names = views();
        if (view.empty()) return names.front();
        if (contains(names, view)) return std::string(view);
        for (const std::string& name : names) {
            if (name.ends_with(fmt::format("/{}", view))) return name;
        }
        throw Error(fmt::format(
            "there is no view \"{}\" in the colour configuration ({}){}\n  there are: {}", view,
            source, did_you_mean(view, names), join(names)));
    }

    /// Applies a processor to the colour of all pixels; grey images are neutral colours.
    void apply(const ocio::ConstProcessorRcPtr& processor, Image& image) const {
        const ocio::ConstCPUProcessorRcPtr cpu = processor->getDefaultCPUProcessor();
        if (image.channel_count() < 3) {
            for (std::size_t i = 0; i < image.pixels.size(); i += image.channel_count()) {
                Color grey(image.pixels[i]);
                cpu->applyRGB(&grey.x);
                image.pixels[i] = grey.y;
            }
            return;
        }
        constexpr auto size = static_cast<std::ptrdiff_t>(sizeof(float));
        const auto pixel = size * static_cast<std::ptrdiff_t>(image.channel_count());
        ocio::PackedImageDesc description(image.pixels.data(), image.width, image.height, 3,
                                          ocio::BIT_DEPTH_F32, size, pixel, pixel * image.width);
        cpu->apply(description);
    }

    /// Calls the library and turns its exceptions into ours.
    template <typename Make>
    ocio::ConstProcessorRcPtr processor(std::string_view what, const Make& make) const {
        try {
            return make(get());
        } catch (const ocio::Exception& error) {
            throw Error(fmt::format("the colour configuration ({}) cannot convert {}: {}", source,
                                    what, error.what()));
        }
    }
};

namespace {

/// Applies f to red, green and blue, or to grey; not to alpha.
template <typename F>
void transform_colors(Image& image, const F& f) {
    const std::size_t stride = image.channel_count();
    const std::size_t colors = stride < 3 ? 1 : 3;
    for (std::size_t i = 0; i < image.pixels.size(); i += stride) {
        for (std::size_t c = 0; c < colors; ++c) image.pixels[i + c] = f(image.pixels[i + c]);
    }
}

void multiply_colors(Image& image, const Matrix3d& matrix) {
    const std::size_t stride = image.channel_count();
    if (stride < 3) return;  // grey stays grey: white is mapped to white
    for (std::size_t i = 0; i < image.pixels.size(); i += stride) {
        float* p = image.pixels.data() + i;
        const Vector3d result = matrix * Vector3d(double{p[0]}, double{p[1]}, double{p[2]});
        for (int c = 0; c < 3; ++c) p[c] = static_cast<float>(result[c]);
    }
}

/// Exposure, and a number for everything that is none. Counts the pixels that needed it.
std::size_t expose_and_sanitise(Image& image, double exposure) {
    const auto gain = static_cast<float>(std::exp2(exposure));
    const std::size_t stride = image.channel_count();
    const std::size_t colors = stride < 3 ? 1 : 3;
    std::size_t non_finite = 0;
    for (std::size_t i = 0; i < image.pixels.size(); i += stride) {
        bool finite = true;
        for (std::size_t c = 0; c < colors; ++c) {
            float& v = image.pixels[i + c];
            finite &= std::isfinite(v);
            v = std::isnan(v) ? 0 : std::clamp(v * gain, -brightest, brightest);
        }
        non_finite += finite ? 0 : 1;
    }
    return non_finite;
}

std::uint8_t to_byte(float v) {
    return static_cast<std::uint8_t>(v > 0 ? std::min(v, 1.0f) * 255 + 0.5f : 0.0f);
}

/// Clamps and rounds; grey is spread over three channels.
Image8 quantise(const Image& image) {
    const std::optional<std::size_t> alpha = image.channel("A");
    Image8 result{.width = image.width, .height = image.height, .channel_count = alpha ? 4 : 3};
    result.pixels.reserve(image.pixel_count() * std::size_t(result.channel_count));
    for (std::size_t i = 0; i < image.pixel_count(); ++i) {
        const Color c = image.rgb(i);
        for (int k = 0; k < 3; ++k) result.pixels.push_back(to_byte(c[k]));
        if (alpha)
            result.pixels.push_back(to_byte(image.pixels[i * image.channel_count() + *alpha]));
    }
    return result;
}

}  // namespace

ColorConfig::ColorConfig() : state_(std::make_unique<State>()) {}
ColorConfig::~ColorConfig() = default;
ColorConfig::ColorConfig(ColorConfig&&) noexcept = default;
ColorConfig& ColorConfig::operator=(ColorConfig&&) noexcept = default;

ColorConfig ColorConfig::choose(std::string_view command_line, std::string_view scene) {
    ColorConfig config;
    State& state = *config.state_;
    const char* variable = std::getenv("OCIO");
    const std::string_view environment = variable ? variable : "";
    const std::string choice(!command_line.empty()  ? command_line
                             : !environment.empty() ? environment
                                                    : scene);
    if (choice.starts_with("ocio://")) {
        state.notice = fmt::format(
            "OpenColorIO {} does not know {}; the built-in colour configuration is used, whose "
            "names are the same",
            ocio::GetVersion(), choice);
    } else if (choice == "none") {
        state.kind = State::Kind::none;
        state.source = "none";
    } else if (!choice.empty() && choice != "builtin") {
        state.load(choice);
    }
    return config;
}

const std::string& ColorConfig::source() const { return state_->source; }
const std::string& ColorConfig::notice() const { return state_->notice; }
const std::string& ColorConfig::rendering_space() const { return state_->rendering_space; }
std::vector<std::string> ColorConfig::spaces() const { return state_->spaces(); }
std::vector<std::string> ColorConfig::views() const { return state_->views(); }

void ColorConfig::to_rendering(Image& image, std::string_view space) const {
    const bool automatic = space == "auto" || space.empty();
    if (automatic && (image.srgb_encoded || image.gamma != 1)) {
        transform_colors(image, [&](float v) { return decoded(image, v); });
    }
    const bool is_xyz = image.channels.size() >= 3 && image.channels[0] == "X" &&
                        image.channels[1] == "Y" && image.channels[2] == "Z";
    if (automatic && is_xyz) {
        multiply_colors(image, rec709_from_xyz);
        std::ranges::copy(std::array{"R", "G", "B"}, image.channels.begin());
        image.chromaticities.reset();
    }
    const std::optional<Chromaticities> chromaticities = image.chromaticities;
    image.srgb_encoded = false;
    image.gamma = 1;
    image.eight_bits = false;
    image.chromaticities.reset();
    if (contains(raw_names, space)) return;

    // First to linear Rec.709 where that is known, then on to the rendering space.
    const bool own = automatic || contains(linear_names, space) || contains(srgb_names, space);
    const bool user = state_->kind == State::Kind::file;
    if (own && (automatic || !user)) {
        if (contains(srgb_names, space)) {
            transform_colors(image, [](float v) { return srgb_to_linear(v); });
        }
        if (automatic && chromaticities && *chromaticities != Chromaticities::rec709()) {
            multiply_colors(image, rec709_from(*chromaticities));
        }
        if (!user) return;
        const auto known = [&](const std::string& n) {
            return state_->get().getColorSpace(n.c_str());
        };
        const auto linear = std::find_if(linear_names.begin(), linear_names.end(), known);
        // A configuration that does not know Rec.709 takes automatic values as they are.
        if (linear == linear_names.end()) return;
        return to_rendering(image, *linear);
    }
    const std::string name = state_->resolve(space);
    state_->apply(state_->processor(name,
                                    [&](const ocio::Config& config) {
                                        return config.getProcessor(name.c_str(),
                                                                   state_->rendering_space.c_str());
                                    }),
                  image);
}

Color ColorConfig::to_rendering(Color color, std::string_view space) const {
    Image pixel(1, 1);
    pixel.set_rgb(0, 0, color);
    to_rendering(pixel, space);
    return pixel.rgb(0, 0);
}

Image8 ColorConfig::display(const Image& image, std::string_view view, double exposure) const {
    const std::string name = state_->resolve_view(view);
    Image shown = image;
    const std::size_t non_finite = expose_and_sanitise(shown, exposure);
    const bool user = state_->kind == State::Kind::file;
    if (!user && name == srgb_view) {
        transform_colors(shown, [](float v) { return linear_to_srgb(v); });
    } else if (user || name != raw_view) {
        const auto make = [&](const ocio::Config& config) {
            std::size_t slash = name.find('/');
            while (!config.getDefaultView(name.substr(0, slash).c_str())[0]) {
                slash = name.find('/', slash + 1);  // a display whose name has a slash
            }
            const auto transform = ocio::DisplayViewTransform::Create();
            transform->setSrc(state_->rendering_space.c_str());
            transform->setDisplay(name.substr(0, slash).c_str());
            transform->setView(name.substr(slash + 1).c_str());
            return config.getProcessor(transform);
        };
        state_->apply(state_->processor("to the view " + name, make), shown);
    }
    Image8 result = quantise(shown);
    result.non_finite = non_finite;
    return result;
}

}  // namespace lucerna
