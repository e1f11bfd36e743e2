// SPDX-License-Identifier: Apache-2.0
/// Where the sun stands (Blanco-Muriel et al. 2001, "Computing the Solar Vector"): to half a minute
/// of arc for the years 1999 to 2015.
#pragma once

#include "core/math/vector.h"

#include <cmath>
#include <numbers>

namespace lucerna {

struct PlaceAndTime {
    double latitude = 0, longitude = 0;  ///< [°], north and east
    double timezone = 0;                 ///< hours ahead of UTC
    int year = 0, month = 1, day = 1;
    double hour = 0;  ///< with its fraction, of the clock there
};

/// Towards the sun: +x is south, +y west, +z up (as in Mitsuba's `sunsky`).
inline Vector3d sun_position(const PlaceAndTime& at) {
    constexpr double degree = std::numbers::pi / 180;
    const double hours = at.hour - at.timezone;  // UTC
    const int shift = (at.month - 14) / 12;
    const int julian_day = (1461 * (at.year + 4800 + shift)) / 4 +
                           (367 * (at.month - 2 - 12 * shift)) / 12 -
                           (3 * ((at.year + 4900 + shift) / 100)) / 4 + at.day - 32075;
    const double n = julian_day - 0.5 + hours / 24 - 2451545.0;  // days since noon, 1 January 2000
    const double omega = 2.1429 - 0.0010394594 * n;
    const double anomaly = 6.2400600 + 0.0172019699 * n;
    const double ecliptic_longitude =
        4.8950630 + 0.017202791698 * n + 0.03341607 * std::sin(anomaly) +
        0.00034894 * std::sin(2 * anomaly) - 0.0001134 - 0.0000203 * std::sin(omega);
    const double obliquity = 0.4090928 - 6.2140e-9 * n + 0.0000396 * std::cos(omega);
    const double right_ascension = std::atan2(std::cos(obliquity) * std::sin(ecliptic_longitude),
                                              std::cos(ecliptic_longitude));
    const double declination = std::asin(std::sin(obliquity) * std::sin(ecliptic_longitude));

    const double sidereal = 6.6974243242 + 0.0657098283 * n + hours;  // at Greenwich [h]
    const double hour_angle = (sidereal * 15 + at.longitude) * degree - right_ascension;
    const double latitude = at.latitude * degree;
    double zenith = std::acos(std::cos(latitude) * std::cos(hour_angle) * std::cos(declination) +
                              std::sin(declination) * std::sin(latitude));
    const double azimuth = std::atan2(-std::sin(hour_angle),
                                      std::tan(declination) * std::cos(latitude) -
                                          std::sin(latitude) * std::cos(hour_angle));  // from north
    zenith += 6371.01 / 149597890 * std::sin(zenith);                                  // parallax
    return {-std::sin(zenith) * std::cos(azimuth), -std::sin(zenith) * std::sin(azimuth),
            std::cos(zenith)};
}

}  // namespace lucerna
