// SPDX-License-Identifier: Apache-2.0
/// The root of everything that a scene can name.
#pragma once

namespace lucerna {

class Scene;

/// Life of an object: its constructor reads parameters; `prepare` runs once when the scene is
/// complete; from then on it is const and used by many threads at once. The scene owns all
/// objects and outlives them; plugins keep plain references to each other.
class Object {
public:
    Object() = default;
    Object(const Object&) = delete;
    Object& operator=(const Object&) = delete;
    virtual ~Object();

    /// For those that need the whole scene: its bounds, its lights. Called on one thread, for
    /// emitters first, then for all others in the order of construction. May throw Error.
    virtual void prepare(const Scene&) {}
};

}  // namespace lucerna
