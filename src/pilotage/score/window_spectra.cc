#include "pilotage/score/window_spectra.h"

namespace pilotage {

int WindowSpectra::step(const BlockCorrelator& correlator, int stride_px) {
  return correlator.windows_per_side() == 1 ? 0 : correlator.hop_px() / stride_px;
}

int WindowSpectra::depth(const BlockCorrelator& correlator, int stride_px) {
  return (correlator.windows_per_side() - 1) * step(correlator, stride_px) + 1;
}

std::size_t WindowSpectra::bytes_per_column(const BlockCorrelator& correlator, int stride_px) {
  return static_cast<std::size_t>(depth(correlator, stride_px)) * correlator.spectrum_size() * sizeof(float);
}

WindowSpectra::WindowSpectra(const BlockCorrelator& correlator, int stride_px, std::int64_t first_column,
                             std::int64_t columns)
    : correlator_(correlator),
      stride_px_(stride_px),
      step_(step(correlator, stride_px)),
      depth_(depth(correlator, stride_px)),
      first_column_(first_column),
      columns_(columns + (correlator.windows_per_side() - 1) * step_),
      rows_(static_cast<std::size_t>(columns_ * depth_), -1),
      spectra_(rows_.size() * correlator.spectrum_size()),
      workspace_(correlator.make_workspace()) {}

const float* WindowSpectra::window(const MapStrip& strip, std::int64_t column, std::int64_t row) {
  const auto slot = static_cast<std::size_t>(row % depth_ * columns_ + column - first_column_);
  float* spectrum = spectra_.data() + slot * correlator_.spectrum_size();
  if (rows_[slot] == row) return spectrum;
  rows_[slot] = row;
  const int side = correlator_.window_px();
  const PixelWindow place{column * stride_px_ - correlator_.radius_px(), row * stride_px_ - correlator_.radius_px(),
                          side, side};
  correlator_.forward(strip.components_of(place, correlator_.lag_step()), workspace_, spectrum);
  return spectrum;
}

std::span<const float* const> WindowSpectra::of_block(const MapStrip& strip, std::int64_t column, std::int64_t row) {
  const int parts = correlator_.windows_per_side();
  of_block_.clear();
  for (int part = 0; part < parts * parts; ++part) {
    of_block_.push_back(window(strip, column + part % parts * step_, row + part / parts * step_));
  }
  return of_block_;
}

}  // namespace pilotage
