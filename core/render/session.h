// SPDX-License-Identifier: Apache-2.0
/// From a scene file to an image: what all commands that render have in common.
///
///     Session session({.scene = "scene.xml"});
///     RenderResult result = session.render({.budget = {.samples = 64}});
#pragma once

#include "core/description/description.h"
#include "core/plugin/registry.h"
#include "core/render/render_job.h"
#include "core/render/state_file.h"
#include "core/render/statistics.h"
#include "core/scene/scene.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace lucerna {

struct SessionSettings {
    std::filesystem::path scene;
    std::vector<std::pair<std::string, std::string>> defines;  ///< `-D name=value`
    std::vector<std::string> overrides;                        ///< `--set path=value`
    std::vector<std::filesystem::path> plugin_folders;         ///< looked into first
    int threads = 0;                                           ///< 0: all processors
};

struct RenderResult {
    FilmState film;
    RenderFigures figures;
    bool interrupted = false;
};

/// A scene that has been read and built, and can be rendered any number of times.
class Session {
public:
    /// Throws SceneError with all that is wrong.
    explicit Session(const SessionSettings& settings);

    const Scene& scene() const { return *scene_; }
    const Description& description() const { return description_; }
    const Registry& registry() const { return registry_; }
    /// What the user should be told although the scene can be rendered.
    const std::vector<Diagnostic>& warnings() const { return warnings_; }

    /// A film without samples.
    FilmState empty_film() const { return FilmState(film_layout(*scene_)); }
    RenderIdentity identity(std::uint64_t seed) const { return {scene_->hash(), seed}; }

    /// Renders, from scratch or from a state of the same render. A budget without any limit becomes
    /// the sampler's `sample_count`; `options.threads` 0 the session's.
    RenderResult render(RenderOptions options, std::optional<RenderState> from = {}) const;

    /// Types, or empty if there is none: "path", "cache".
    std::string integrator() const { return opened(Integrator::kind); }
    std::string light_sampler() const;
    /// What states say of their scene and of the processors that it is rendered on: this one, and
    /// those of the samples before.
    PartRecord record(std::set<std::uint64_t> earlier_roundings = {}) const;

private:
    std::string opened(const char* kind) const;

    /// First of all, since it tells TBB how many threads there may be.
    Workers workers_;
    std::filesystem::path scene_file_;
    Registry registry_;
    Description description_;
    std::vector<Diagnostic> warnings_;
    std::unique_ptr<Scene> scene_;
    double load_seconds_ = 0, build_seconds_ = 0;
};

}  // namespace lucerna
