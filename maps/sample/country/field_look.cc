#include "country/field_look.h"

#include <array>
#include <cstddef>

namespace pilotage::scene_detail {
namespace {

constexpr Rgb kSoil{134, 113, 88};
constexpr Rgb kDarkSoil{106, 89, 72};
constexpr Rgb kStraw{178, 160, 118};

// One row a crop: June, then September of the next year.
// colour, soil, patches, mottle, rows, row spacing, tramlines, swaths, grain
constexpr std::array<std::array<FieldLook, 2>, kCropCount> kLooks = {{
    // Winter wheat; then stubble with straw.
    {{{{112, 124, 70}, kSoil, 0.09F, 0.05F, 0.03F, 2.0F, 0.55F, 0, 0.05F},
      {{170, 151, 110}, kSoil, 0.08F, 0.05F, 0.05F, 1.5F, 0.25F, 0.10F, 0.07F}}},
    // Winter barley, ripening; then ploughed.
    {{{{168, 158, 98}, kSoil, 0.07F, 0.06F, 0.02F, 2.0F, 0.45F, 0, 0.05F},
      {{118, 99, 79}, kDarkSoil, 0.13F, 0.04F, 0.07F, 1.6F, 0, 0, 0.08F}}},
    // Oilseed rape in pod; then a new green crop.
    {{{{126, 136, 78}, kSoil, 0.06F, 0.09F, 0, 2.0F, 0.50F, 0, 0.07F},
      {{104, 114, 68}, kSoil, 0.12F, 0.05F, 0.04F, 1.5F, 0.30F, 0, 0.05F}}},
    // Maize in young rows; then tall and yellowing.
    {{{{129, 121, 82}, kSoil, 0.12F, 0.04F, 0.12F, 1.5F, 0, 0, 0.06F},
      {{108, 112, 62}, kDarkSoil, 0.05F, 0.07F, 0.05F, 1.5F, 0, 0, 0.10F}}},
    // Sugar beet; then half lifted.
    {{{{94, 118, 62}, kDarkSoil, 0.07F, 0.05F, 0.07F, 1.5F, 0.60F, 0, 0.06F},
      {{86, 108, 54}, kDarkSoil, 0.06F, 0.08F, 0.06F, 1.5F, 0.50F, 0, 0.08F}}},
    // Bare seed bed; then a catch crop.
    {{{{152, 131, 103}, kDarkSoil, 0.15F, 0.04F, 0.04F, 3.0F, 0.20F, 0, 0.05F},
      {{116, 122, 76}, kSoil, 0.10F, 0.08F, 0, 2.0F, 0, 0, 0.07F}}},
    // Ley; then mown.
    {{{{102, 126, 66}, kSoil, 0.07F, 0.08F, 0, 2.0F, 0, 0.05F, 0.07F},
      {{136, 140, 84}, kStraw, 0.06F, 0.04F, 0.02F, 3.0F, 0, 0.10F, 0.05F}}},
    // Spring wheat, dark; then cultivated stubble.
    {{{{88, 112, 62}, kSoil, 0.08F, 0.04F, 0.02F, 2.0F, 0.55F, 0, 0.04F},
      {{146, 125, 96}, kStraw, 0.12F, 0.06F, 0.07F, 2.6F, 0, 0, 0.08F}}},
    // Potatoes in ridges; then harvested soil.
    {{{{104, 112, 68}, kSoil, 0.09F, 0.05F, 0.13F, 1.8F, 0.50F, 0, 0.06F},
      {{140, 118, 92}, kDarkSoil, 0.12F, 0.05F, 0.06F, 1.8F, 0, 0, 0.08F}}},
}};

}  // namespace

const FieldLook& field_look(int crop, SceneEpoch epoch) {
  return kLooks[static_cast<std::size_t>(crop)][static_cast<std::size_t>(epoch_index(epoch))];
}

}  // namespace pilotage::scene_detail
