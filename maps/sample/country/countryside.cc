#include "country/countryside.h"

#include <array>
#include <cmath>

#include "country/noise.h"
#include "pilotage/base/random.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

void add_tree(Random& random, const Vector2d& p, double radius_m, Stands& stands) {
  stands.trees.push_back({p, radius_m, radius_m * random.uniform(1.8, 2.8) + 0.6, random.next()});
}

void plant_hedge(Random& random, const GroundGrid& ground, const ParcelEdge& edge, Stands& stands) {
  const double length = (edge.to - edge.from).norm();
  const double density = random.uniform(0.25, 1.0);  // from a row of single trees to a closed hedge
  for (double t = random.uniform(1, 5); t < length - 1; t += random.uniform(1.8, 4.2)) {
    const bool gap = random.uniform() > density;
    const bool tall = random.uniform() < 0.22;
    const double side = random.uniform(-0.9, 0.9);
    const double radius = tall ? random.uniform(2.6, 4.8) : random.uniform(1.1, 2.1);
    if (gap && !tall) continue;
    const Vector2d p = ground_from_bent(ground, edge.from + edge.direction() * t + edge.normal * side);
    if (ground.at(p).water_m < 1) add_tree(random, p, radius, stands);
  }
}

void plant_avenue(Random& random, const GroundGrid& ground, const ParcelEdge& edge, Stands& stands) {
  const double length = (edge.to - edge.from).norm();
  for (double t = random.uniform(4, 12); t < length - 4; t += random.uniform(8, 16)) {
    const double side = edge.half_width_m + random.uniform(1.8, 3.0);
    const bool left = random.uniform() < 0.5;
    const double radius = random.uniform(1.8, 3.8);
    if (random.uniform() < 0.3) continue;
    const Vector2d p = ground_from_bent(ground, edge.from + edge.direction() * t + edge.normal * (left ? side : -side));
    if (ground.at(p).water_m < 1) add_tree(random, p, radius, stands);
  }
}

}  // namespace

void plant_parcel(const GroundGrid& ground, const Parcels& parcels, const Parcel& parcel, Stands& stands) {
  Random random(derive_seed(parcel.seed, 1));
  const ParcelEdge* edges = parcels.edges_of(parcel);
  for (int i = 0; i < parcel.edge_count; ++i) {
    const ParcelEdge& edge = edges[i];
    const double chance = random.uniform();
    if (edge.normal.x() <= 0) continue;
    if (edge.kind == EdgeKind::kHedge) plant_hedge(random, ground, edge, stands);
    const bool road = edge.kind == EdgeKind::kRoad || edge.kind == EdgeKind::kMainRoad;
    if (road && chance < 0.35) plant_avenue(random, ground, edge, stands);
  }
  if (parcel.use != LandUse::kMeadow && parcel.use != LandUse::kPit) return;
  for (int i = 0; i < static_cast<int>(parcel.area_m2 / 2200); ++i) {
    const double reach = std::sqrt(parcel.area_m2);
    const Vector2d q = parcel.center_m + Vector2d(random.uniform(-reach, reach), random.uniform(-reach, reach));
    const double radius = random.uniform(0.8, 3.6);
    const Vector2d p = ground_from_bent(ground, q);
    if (clearance_m(parcels, parcel, q) > 2 && ground.at(p).water_m < -2) add_tree(random, p, radius, stands);
  }
}

void plant_banks(std::uint64_t seed, const GroundGrid& ground, double width_m, double height_m, Stands& stands) {
  constexpr double kCell_m = 5.5;
  for (std::int64_t row = 0; static_cast<double>(row) * kCell_m < height_m; ++row) {
    for (std::int64_t column = 0; static_cast<double>(column) * kCell_m < width_m; ++column) {
      Random random(lattice_hash(seed, column, row));
      const Vector2d p((static_cast<double>(column) + random.uniform()) * kCell_m,
                       (static_cast<double>(row) + random.uniform()) * kCell_m);
      const float water = ground.at(p).water_m;
      if (water > -4 || water < -15) continue;
      const float wooded = gradient_noise(seed + 1, p.x() / 90, p.y() / 90);
      if (random.uniform() < 0.30 + 0.6 * wooded) add_tree(random, p, random.uniform(1.6, 4.4), stands);
    }
  }
}

void drive_roads(const GroundGrid& ground, const Parcels& parcels, const Parcel& parcel, Stands& stands) {
  Random random(derive_seed(parcel.seed, 2));
  const ParcelEdge* edges = parcels.edges_of(parcel);
  for (int i = 0; i < parcel.edge_count; ++i) {
    const ParcelEdge& edge = edges[i];
    if (edge.kind != EdgeKind::kMainRoad && edge.kind != EdgeKind::kRoad && edge.kind != EdgeKind::kStreet) continue;
    const double length = (edge.to - edge.from).norm();
    const double spacing = edge.kind == EdgeKind::kStreet ? 38 : (edge.kind == EdgeKind::kMainRoad ? 110 : 260);
    for (double t = random.uniform(0, spacing); t < length; t += random.uniform(0.3, 1.7) * spacing) {
      const Vector2d q = edge.from + edge.direction() * t + edge.normal * (edge.half_width_m * 0.5);
      const Vector2d p = ground_from_bent(ground, q);
      const Vector2d ahead = ground_from_bent(ground, q + 4 * edge.direction());
      const std::uint8_t epochs = random.uniform() < 0.5 ? 1 : 2;
      stands.boxes.push_back(make_vehicle(random.next(), p, (ahead - p).normalized(), epochs));
    }
  }
}

void build_farm(std::uint64_t seed, const GroundGrid& ground, const Vector2d& q, const Vector2d& direction,
                Stands& stands) {
  Random random(seed);
  const Vector2d across(-direction.y(), direction.x());
  constexpr std::array<Rgb, 4> kRoofs = {{{142, 92, 72}, {128, 126, 124}, {112, 88, 76}, {160, 158, 152}}};
  const std::array<Vector2d, 4> places = {Vector2d(0, 24), Vector2d(0, -22), Vector2d(34, 0), Vector2d(-31, 4)};
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (i == 3 && random.uniform() < 0.4) continue;
    Box barn;
    barn.center_m = ground_from_bent(ground, q + direction * places[i].x() + across * places[i].y());
    barn.along = i < 2 ? direction : across;
    barn.half_length_m = i == 3 ? random.uniform(6, 8) : random.uniform(10, 19);
    barn.half_width_m = i == 3 ? random.uniform(4.5, 5.5) : random.uniform(5.5, 8.5);
    barn.height_m = random.uniform(4, 6);
    barn.rise_m = barn.half_width_m * random.uniform(0.4, 0.7);
    barn.colour = kRoofs[random.below(kRoofs.size())];
    barn.seed = random.next();
    stands.boxes.push_back(barn);
  }
  for (int i = 0; i < 14; ++i) {
    const double angle = random.uniform(0, 6.283185307179586);
    const double reach = random.uniform(40, 58);
    const Vector2d p = ground_from_bent(ground, q + reach * Vector2d(std::cos(angle), std::sin(angle)));
    add_tree(random, p, random.uniform(1.8, 4.6), stands);
  }
  for (int i = 0; i < 4; ++i) {
    const Vector2d p = ground_from_bent(ground, q + Vector2d(random.uniform(-12, 12), random.uniform(-9, 9)));
    stands.boxes.push_back(make_vehicle(random.next(), p, i % 2 == 0 ? direction : across, i < 2 ? 1 : 2));
  }
}

}  // namespace pilotage::scene_detail
