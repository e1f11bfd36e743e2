// SPDX-License-Identifier: Apache-2.0
/// Pictures of what a plugin samples, beside what it says that it samples.
#pragma once

#include "plugins/commands/check/subject.h"
#include "plugins/commands/contracts/finding.h"

namespace lucerna {

/// Writes a PNG. Each row is one situation, with one scale of brightness:
///
///   bsdf           drawn directions, their density, f |cos θ|; the axes are azimuth and cos θ
///   phase          the same, with f
///   light_sampler  frequencies of draws, pmf; a row for each point, a column for each light
///   shape          area samples in a view, and what rays through its pixels expect
///   emitter        particles on a ball, and its irradiance; azimuth and cos θ of the normal
///   texture        the unit square
///   rfilter        the filter from −radius to radius
///   sampler        pairs of dimensions: 1024 samples of a sequence, and of as many sequences
///   sensor         importance over the film, and directions of rays as colours
///
/// Throws FileError if the file cannot be written.
void draw_picture(Subject& subject, const Effort& effort, const std::filesystem::path& path);

}  // namespace lucerna
