#include "country/world.h"

#include <algorithm>
#include <utility>

#include "country/countryside.h"
#include "country/noise.h"
#include "country/settlement.h"
#include "pilotage/base/random.h"

namespace pilotage::scene_detail {
namespace {

using Eigen::Vector2d;

std::uint64_t stream(std::uint64_t seed, std::string_view name) {
  return derive_seed(seed, seed_from_name(name));
}

/// Farms beside roads, far from each other and from the settlements.
void place_farms(std::uint64_t seed, const World& world, Parcels& parcels, Stands& stands) {
  constexpr int kFarms = 9;
  std::vector<Vector2d> placed;
  for (Parcel& parcel : parcels.parcels) {
    if (parcel.use != LandUse::kArable || static_cast<int>(placed.size()) >= kFarms) continue;
    const ParcelEdge* edges = parcels.edges_of(parcel);
    const ParcelEdge* road = std::find_if(edges, edges + parcel.edge_count, [](const ParcelEdge& edge) {
      return (edge.kind == EdgeKind::kRoad || edge.kind == EdgeKind::kMainRoad) && (edge.to - edge.from).norm() > 120;
    });
    if (road == edges + parcel.edge_count) continue;
    const Vector2d q = (road->from + road->to) / 2 + road->normal * (road->half_width_m + 46);
    const bool crowded =
        std::any_of(placed.begin(), placed.end(), [&](const Vector2d& other) { return (q - other).norm() < 430; });
    if (crowded || clearance_m(parcels, parcel, q) < 40 || (q - world.sites.town).norm() < 520) continue;
    if (world.ground.at(ground_from_bent(world.ground, q)).water_m > -60) continue;
    placed.push_back(q);
    parcel.yard_m = q;
    parcel.yard_radius_m = 44;
    build_farm(lattice_hash(seed, static_cast<std::int64_t>(placed.size()), 0), world.ground, q, road->direction(),
               stands);
  }
}

bool stands_near(const Stands& stands, const Vector2d& p, double radius_m) {
  const auto near_box = [&](const Box& box) {
    return (box.center_m - p).norm() < radius_m + std::hypot(box.half_length_m, box.half_width_m);
  };
  const auto near_tree = [&](const Tree& tree) { return (tree.center_m - p).norm() < radius_m + tree.radius_m; };
  return std::any_of(stands.boxes.begin(), stands.boxes.end(), near_box) ||
         std::any_of(stands.trees.begin(), stands.trees.end(), near_tree);
}

/// Round landmarks on fields and meadows, clear of roads, hedges and of what stands there.
void place_landmarks(std::uint64_t seed, int of_each, const World& world, Stands& stands) {
  constexpr double kMargin_m = 80;
  constexpr int kDraws = 400;
  static constexpr BoxKind kKinds[] = {BoxKind::kTank, BoxKind::kRoundabout, BoxKind::kRing};
  for (std::int64_t kind = 0; kind < 3; ++kind) {
    Random random(static_cast<std::uint64_t>(lattice_hash(seed, kind, 0)));
    int placed = 0;
    for (int draw = 0; draw < kDraws * of_each && placed < of_each; ++draw) {
      const Vector2d p(random.uniform(kMargin_m, world.width_m - kMargin_m),
                       random.uniform(kMargin_m, world.height_m - kMargin_m));
      Box box;
      box.center_m = p;
      box.along = {1, 0};
      box.kind = kKinds[kind];
      box.half_length_m = box.half_width_m = random.uniform(7, 14);
      box.height_m = box.kind == BoxKind::kTank ? random.uniform(5, 12) : 0.05;
      const auto tone = static_cast<float>(random.uniform(0.75, 1.0));
      box.colour = Rgb{226, 224, 216} * tone;
      box.seed = random.next();
      const GroundNode node = world.ground.at(p);
      const Vector2d q = p + Vector2d(node.bend_x_m, node.bend_y_m);
      const Parcel& parcel = world.parcels.parcels[static_cast<std::size_t>(world.parcels.locate(q))];
      const bool open = parcel.use == LandUse::kArable || parcel.use == LandUse::kMeadow;
      if (!open || node.water_m > -30 || node.lake_m > -30) continue;
      if (clearance_m(world.parcels, parcel, q) < box.half_length_m + 6) continue;
      if (stands_near(stands, p, box.half_length_m + 8)) continue;
      stands.boxes.push_back(box);
      ++placed;
    }
  }
}

Stands build_all(std::uint64_t seed, int landmarks, World& world) {
  Stands stands;
  for (const Parcel& parcel : world.parcels.parcels) {
    const Vector2d center = ground_from_bent(world.ground, parcel.center_m);
    const bool dry = world.ground.at(center).water_m < -25;
    if (parcel.use == LandUse::kDwellings && dry) build_dwellings(world.ground, world.parcels, parcel, stands);
    if (parcel.use == LandUse::kWorks && dry) build_works(world.ground, world.parcels, parcel, stands);
    if (parcel.use == LandUse::kGreen && dry) plant_park(world.ground, world.parcels, parcel, stands);
    plant_parcel(world.ground, world.parcels, parcel, stands);
    drive_roads(world.ground, world.parcels, parcel, stands);
  }
  place_farms(stream(seed, "farms"), world, world.parcels, stands);
  plant_banks(stream(seed, "banks"), world.ground, world.width_m, world.height_m, stands);
  std::erase_if(stands.boxes, [&](const Box& box) {
    return world.ground.at(box.center_m).water_m > -3 && box.kind != BoxKind::kVehicle;
  });
  std::erase_if(stands.boxes, [&](const Box& box) { return world.ground.at(box.center_m).lake_m > -8; });
  place_landmarks(stream(seed, "landmarks"), landmarks, world, stands);
  return stands;
}

}  // namespace

World make_world(const SceneOptions& options) {
  const auto seed = static_cast<std::uint64_t>(options.seed);
  World world;
  world.seed = stream(seed, "texture");
  world.width_m = options.width_m;
  world.height_m = options.height_m;
  world.waters = make_waters(stream(seed, "waters"), options.width_m, options.height_m);
  world.ground = make_ground(stream(seed, "ground"), world.waters);
  world.sites = make_sites(stream(seed, "sites"), world.waters);
  const std::uint64_t use_seed = stream(seed, "land use");
  ParcelPlan plan;
  plan.width_m = options.width_m;
  plan.height_m = options.height_m;
  plan.margin_m = 250;
  plan.in_town = [&](const Vector2d& q) { return in_settlement(use_seed, world.sites, q); };
  plan.in_lake = [&](const Vector2d& q) { return world.waters.lake_depth_m(q) > -15; };
  world.parcels = make_parcels(stream(seed, "parcels"), plan);
  assign_land_use(use_seed, world.ground, world.parcels, world.sites);
  Stands stands = build_all(seed, options.landmarks, world);
  const double margin = 60;
  world.objects = index_objects(std::move(stands.boxes), std::move(stands.trees), Vector2d(-margin, -margin),
                                Vector2d(options.width_m + margin, options.height_m + margin));
  return world;
}

}  // namespace pilotage::scene_detail
