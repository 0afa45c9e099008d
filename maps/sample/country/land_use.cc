#include "country/land_use.h"

#include <algorithm>
#include <vector>

#include "country/field_look.h"
#include "country/noise.h"
#include "pilotage/base/random.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

/// Gives `use` to the arable parcels nearest to `site` until they cover `share` of the scene; returns the largest one's
/// centre.
Vector2d claim(Parcels& parcels, const Vector2d& site, double area_m2, double min_parcel_m2, LandUse use) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < parcels.parcels.size(); ++i) {
    const Parcel& parcel = parcels.parcels[i];
    if (parcel.use == LandUse::kArable && parcel.area_m2 >= min_parcel_m2) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return (parcels.parcels[a].center_m - site).squaredNorm() < (parcels.parcels[b].center_m - site).squaredNorm();
  });
  Vector2d center = site;
  double largest_m2 = 0;
  double claimed_m2 = 0;
  for (const std::size_t i : order) {
    if (claimed_m2 >= area_m2) break;
    Parcel& parcel = parcels.parcels[i];
    parcel.use = use;
    claimed_m2 += parcel.area_m2;
    if (parcel.area_m2 > largest_m2) {
      largest_m2 = parcel.area_m2;
      center = parcel.center_m;
    }
  }
  return center;
}

LandUse town_use(Random& random, double from_center_m, double radius_m) {
  const double r = random.uniform();
  if (from_center_m > 0.62 * radius_m && r < 0.30) return LandUse::kWorks;
  if (r < 0.08) return LandUse::kGreen;
  if (r < 0.16) return LandUse::kWorks;
  return LandUse::kDwellings;
}

}  // namespace

SceneSites make_sites(std::uint64_t seed, const Waters& waters) {
  Random random(seed);
  const auto place = [&](double x, double y) {
    return Vector2d(waters.width_m * (x + random.uniform(-0.015, 0.015)),
                    waters.height_m * (y + random.uniform(-0.02, 0.02)));
  };
  SceneSites sites;
  sites.town = place(0.42, 0.33);
  sites.hamlet = place(0.80, 0.46);
  sites.lake = waters.lake_center_m;
  sites.forest = place(0.84, 0.80);
  sites.orchard = place(0.66, 0.22);
  sites.fields = place(0.14, 0.26);
  sites.town_radius_m = 360;
  sites.hamlet_radius_m = 120;
  return sites;
}

bool in_settlement(std::uint64_t seed, const SceneSites& sites, const Vector2d& p) {
  const double uneven = 1 + 0.28 * gradient_noise(seed, p.x() / 240, p.y() / 240);
  return (p - sites.town).norm() < sites.town_radius_m * uneven ||
         (p - sites.hamlet).norm() < sites.hamlet_radius_m * uneven;
}

void assign_land_use(std::uint64_t seed, const GroundGrid& ground, Parcels& parcels, SceneSites& sites) {
  Random random(seed);
  double total_m2 = 0;
  for (Parcel& parcel : parcels.parcels) {
    total_m2 += parcel.area_m2;
    parcel.crop = static_cast<int>(random.below(kCropCount));
    const double meadow = random.uniform();
    const bool wet = ground.at(ground_from_bent(ground, parcel.center_m)).water_m > -70;
    if (in_settlement(seed, sites, parcel.center_m) && parcel.area_m2 < 14000) {
      parcel.use = town_use(random, (parcel.center_m - sites.town).norm(), sites.town_radius_m);
    } else if (meadow < (wet ? 0.75 : 0.10)) {
      parcel.use = LandUse::kMeadow;
    }
  }
  const Vector2d conifers = sites.forest + Vector2d(-420, -60);
  sites.forest = claim(parcels, sites.forest, 0.110 * total_m2, 9000, LandUse::kForest);
  claim(parcels, conifers, 0.030 * total_m2, 9000, LandUse::kConifers);
  claim(parcels, Vector2d(0.05, 0.66).cwiseProduct(Vector2d(sites.lake.x() / 0.29, sites.lake.y() / 0.8)),
        0.035 * total_m2, 9000, LandUse::kForest);
  sites.orchard = claim(parcels, sites.orchard, 0.038 * total_m2, 18000, LandUse::kOrchard);
  claim(parcels, sites.town + Vector2d(330, 820), 0.009 * total_m2, 9000, LandUse::kPit);
  claim(parcels, sites.fields + Vector2d(60, -180), 0.012 * total_m2, 3000, LandUse::kForest);
  double nearest = 1e300;
  Vector2d fields = sites.fields;
  for (const Parcel& parcel : parcels.parcels) {
    const double distance = (parcel.center_m - sites.fields).norm();
    if (parcel.use != LandUse::kArable || parcel.area_m2 < 25000 || distance >= nearest) continue;
    nearest = distance;
    fields = parcel.center_m;
  }
  sites.fields = ground_from_bent(ground, fields);
  sites.forest = ground_from_bent(ground, sites.forest);
  sites.orchard = ground_from_bent(ground, sites.orchard);
}

}  // namespace pilotage::scene_detail
