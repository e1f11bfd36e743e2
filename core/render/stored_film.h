// SPDX-License-Identifier: Apache-2.0
/// The film of a scene as text: what a state file keeps, so that a picture can be made of it
/// without the scene.
#pragma once

#include "core/description/description.h"
#include "core/interfaces/film.h"
#include "core/plugin/registry.h"

#include <memory>
#include <string>
#include <vector>

namespace lucerna {

/// "hdrfilm", and a line "name=value" for each parameter that is given. The reconstruction filter
/// is left out: the pixels have been through it.
std::string film_text(const Description& description);

/// A film made of such text, for Film::write and Film::extension.
class StoredFilm {
public:
    /// An empty text is the default film. Throws Error for parameters that the plugin refuses.
    StoredFilm(const std::string& text, Registry& registry);
    const Film& operator*() const { return *film_; }

private:
    std::vector<std::unique_ptr<Object>> objects_;
    const Film* film_;
};

}  // namespace lucerna
