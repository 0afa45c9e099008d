#include "country/settlement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pilotage/base/random.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

constexpr std::array<Rgb, 9> kTiles = {{{166, 92, 66},
                                        {150, 82, 62},
                                        {178, 104, 74},
                                        {140, 96, 78},
                                        {120, 84, 72},
                                        {98, 98, 104},
                                        {84, 84, 88},
                                        {130, 124, 120},
                                        {158, 112, 88}}};
constexpr std::array<Rgb, 6> kHallRoofs = {
    {{196, 196, 192}, {170, 172, 174}, {150, 150, 148}, {118, 122, 128}, {182, 172, 160}, {112, 128, 142}}};
constexpr std::array<Rgb, 8> kPaints = {{{222, 222, 222},
                                         {200, 202, 206},
                                         {60, 62, 66},
                                         {44, 46, 50},
                                         {150, 152, 156},
                                         {146, 44, 40},
                                         {52, 76, 118},
                                         {178, 176, 164}}};

/// A point and a direction of the block's bent coordinates, on the ground.
struct Pose {
  Vector2d center_m;
  Vector2d along;
};

Pose on_ground(const GroundGrid& ground, const Vector2d& q, const Vector2d& direction) {
  const Vector2d center = ground_from_bent(ground, q);
  return {center, (ground_from_bent(ground, q + 4 * direction) - center).normalized()};
}

bool overlaps_any(const std::vector<Box>& boxes, std::size_t first, const Box& box, double gap_m) {
  for (std::size_t i = first; i < boxes.size(); ++i) {
    const double reach =
        std::hypot(boxes[i].half_length_m, boxes[i].half_width_m) + std::hypot(box.half_length_m, box.half_width_m);
    if ((boxes[i].center_m - box.center_m).norm() < 0.86 * reach + gap_m) return true;
  }
  return false;
}

Box make_house(Random& random, const Pose& pose) {
  Box house;
  house.center_m = pose.center_m;
  const bool turned = random.uniform() < 0.38;
  house.along = turned ? left_of(pose.along) : pose.along;
  house.half_length_m = random.uniform(5.2, 7.6);
  house.half_width_m = random.uniform(3.9, 5.2);
  house.height_m = random.uniform(3.2, 6.2);
  house.rise_m = house.half_width_m * random.uniform(0.55, 0.95);
  const double kind = random.uniform();
  house.kind = kind < 0.66 ? BoxKind::kGable : (kind < 0.88 ? BoxKind::kHip : BoxKind::kFlat);
  house.colour = kTiles[random.below(kTiles.size())] * static_cast<float>(random.uniform(0.85, 1.15));
  if (house.kind == BoxKind::kFlat) {
    house.rise_m = 0;
    house.colour = kHallRoofs[random.below(kHallRoofs.size())] * 0.85F;
  }
  house.seed = random.next();
  // A few houses are built between the dates, a few are gone.
  const double change = random.uniform();
  house.epochs = change < 0.025 ? 2 : (change > 0.985 ? 1 : 3);
  return house;
}

Box make_shed(Random& random, const Pose& pose) {
  Box shed;
  shed.center_m = pose.center_m;
  shed.along = pose.along;
  shed.half_length_m = random.uniform(1.6, 3.4);
  shed.half_width_m = random.uniform(1.3, 2.2);
  shed.height_m = random.uniform(2.1, 2.8);
  shed.kind = BoxKind::kFlat;
  shed.colour = kTiles[random.below(kTiles.size())] * 0.95F;
  shed.seed = random.next();
  return shed;
}

void add_tree(const GroundGrid& ground, Random& random, const Vector2d& q, Stands& stands) {
  const double radius = random.uniform(1.3, 4.2);
  stands.trees.push_back({ground_from_bent(ground, q), radius, radius * random.uniform(1.7, 2.6) + 0.8, random.next()});
}

/// A random point of the parcel with at least `clear_m` to its edges, or nothing after some attempts.
std::optional<Vector2d> random_point(Random& random, const Parcels& parcels, const Parcel& parcel, double clear_m) {
  const double reach = 1.4 * std::sqrt(parcel.area_m2);
  for (int attempt = 0; attempt < 12; ++attempt) {
    const Vector2d q = parcel.center_m + Vector2d(random.uniform(-reach, reach), random.uniform(-reach, reach));
    if (clearance_m(parcels, parcel, q) >= clear_m) return q;
  }
  return std::nullopt;
}

void add_car_park(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Random& random,
                  const Box& hall, Stands& stands) {
  // Two rows of bays beside the hall's long side.
  const Vector2d across = left_of(hall.along);
  for (int row = 0; row < 3; ++row) {
    for (double t = -hall.half_length_m; t < hall.half_length_m; t += 2.7) {
      const std::uint64_t seed = random.next();
      const double side = hall.half_width_m + 7.0 + 5.2 * row + (row == 2 ? 6.0 : 0.0);
      const Vector2d center = hall.center_m + hall.along * t + across * side;
      if (clearance_m(parcels, block, bent_from_ground(ground, center)) < 3) continue;
      const double first = random.uniform();
      const double second = random.uniform();
      const int epochs = (first < 0.55 ? 1 : 0) + (second < 0.5 ? 2 : 0);
      if (epochs != 0) stands.boxes.push_back(make_vehicle(seed, center, across, static_cast<std::uint8_t>(epochs)));
    }
  }
}

}  // namespace

double clearance_m(const Parcels& parcels, const Parcel& parcel, const Vector2d& q) {
  double clearance = 1e300;
  const ParcelEdge* edges = parcels.edges_of(parcel);
  for (int i = 0; i < parcel.edge_count; ++i)
    clearance = std::min(clearance, edges[i].distance_m(q) - edges[i].half_width_m);
  return clearance;
}

Box make_vehicle(std::uint64_t seed, const Vector2d& center_m, const Vector2d& along, std::uint8_t epochs) {
  Random random(seed);
  Box vehicle;
  vehicle.center_m = center_m;
  vehicle.along = along;
  const bool lorry = random.uniform() < 0.07;
  vehicle.half_length_m = lorry ? random.uniform(3.8, 6.5) : random.uniform(2.0, 2.4);
  vehicle.half_width_m = lorry ? 1.25 : 0.92;
  vehicle.height_m = lorry ? 3.4 : 1.5;
  vehicle.kind = BoxKind::kVehicle;
  vehicle.colour = kPaints[random.below(kPaints.size())];
  vehicle.seed = seed;
  vehicle.epochs = epochs;
  return vehicle;
}

void build_dwellings(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands) {
  Random random(block.seed);
  const std::size_t first = stands.boxes.size();
  const ParcelEdge* edges = parcels.edges_of(block);
  for (int i = 0; i < block.edge_count; ++i) {
    const ParcelEdge& edge = edges[i];
    if (edge.kind == EdgeKind::kStrip || edge.kind == EdgeKind::kOuter) continue;
    const double length = (edge.to - edge.from).norm();
    for (double t = random.uniform(11, 16); t < length - 10; t += random.uniform(15, 21)) {
      const Vector2d lot = edge.from + edge.direction() * t;
      const double depth = edge.half_width_m + random.uniform(9.5, 13);
      const Box house = make_house(random, on_ground(ground, lot + edge.normal * depth, edge.direction()));
      if (clearance_m(parcels, block, lot + edge.normal * depth) < 8 || overlaps_any(stands.boxes, first, house, 1))
        continue;
      stands.boxes.push_back(house);
      if (random.uniform() < 0.55) {
        const Vector2d yard =
            lot + edge.normal * (depth + random.uniform(10, 17)) + edge.direction() * random.uniform(-6, 6);
        const Box shed = make_shed(random, on_ground(ground, yard, edge.direction()));
        if (clearance_m(parcels, block, yard) > 5 && !overlaps_any(stands.boxes, first, shed, 0.6))
          stands.boxes.push_back(shed);
      }
      const double parked = random.uniform();
      if (parked < 0.5) {
        const Pose drive =
            on_ground(ground, lot + edge.normal * (edge.half_width_m + 4.2) + edge.direction() * 6.5, edge.normal);
        const Box car =
            make_vehicle(random.next(), drive.center_m, drive.along, parked < 0.2 ? 1 : (parked < 0.4 ? 2 : 3));
        if (car.half_length_m < 3) stands.boxes.push_back(car);  // lorries do not fit
      }
    }
  }
  const int trees = static_cast<int>(block.area_m2 / 260);
  for (int i = 0; i < trees; ++i) {
    const auto q = random_point(random, parcels, block, 1.5);
    if (q) add_tree(ground, random, *q, stands);
  }
}

void build_works(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands) {
  Random random(block.seed);
  const std::size_t first = stands.boxes.size();
  for (int i = 0; i < 14; ++i) {
    const auto q = random_point(random, parcels, block, 14);
    if (!q) continue;
    const Pose pose = on_ground(ground, *q, block.rows);
    Box hall;
    hall.center_m = pose.center_m;
    hall.along = random.uniform() < 0.7 ? pose.along : left_of(pose.along);
    hall.half_length_m = random.uniform(9, 25);
    hall.half_width_m = random.uniform(6, 12.5);
    hall.height_m = random.uniform(5.5, 9.5);
    const bool gabled = random.uniform() < 0.4;
    hall.rise_m = gabled ? hall.half_width_m * 0.28 : 0;
    hall.kind = gabled ? BoxKind::kGable : BoxKind::kFlat;
    hall.colour = kHallRoofs[random.below(kHallRoofs.size())] * static_cast<float>(random.uniform(0.85, 1.08));
    hall.seed = random.next();
    hall.epochs = random.uniform() < 0.06 ? 2 : 3;
    const double reach = std::hypot(hall.half_length_m, hall.half_width_m);
    if (clearance_m(parcels, block, *q) < 0.62 * reach || overlaps_any(stands.boxes, first, hall, 2)) continue;
    stands.boxes.push_back(hall);
    if (random.uniform() < 0.6) add_car_park(ground, parcels, block, random, hall, stands);
  }
  for (int i = 0; i < static_cast<int>(block.area_m2 / 1500); ++i) {
    const auto q = random_point(random, parcels, block, 1.5);
    if (q && clearance_m(parcels, block, *q) < 8) add_tree(ground, random, *q, stands);
  }
}

void plant_park(const GroundGrid& ground, const Parcels& parcels, const Parcel& block, Stands& stands) {
  Random random(block.seed);
  for (int i = 0; i < static_cast<int>(block.area_m2 / 210); ++i) {
    const auto q = random_point(random, parcels, block, 2);
    if (q && (clearance_m(parcels, block, *q) < 16 || random.uniform() < 0.4)) add_tree(ground, random, *q, stands);
  }
}

}  // namespace pilotage::scene_detail
