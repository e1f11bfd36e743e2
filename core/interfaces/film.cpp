// SPDX-License-Identifier: Apache-2.0
#include "core/interfaces/film.h"

namespace lucerna {

Film::~Film() = default;

}  // namespace lucerna
