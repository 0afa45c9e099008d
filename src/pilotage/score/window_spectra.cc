#include "pilotage/score/window_spectra.h"

#include "pilotage/base/parallel.h"

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
      slots_(static_cast<std::size_t>(columns_ * depth_)) {}

std::size_t WindowSpectra::slot_index(std::int64_t column, std::int64_t row) const {
  return static_cast<std::size_t>(row % depth_ * columns_ + column - first_column_);
}

void WindowSpectra::prepare(const MapStrip& strip, std::int64_t row, const std::function<bool(std::int64_t)>& needed,
                            std::vector<RealFft2d::Workspace>& workspaces, int threads) {
  const int parts = correlator_.windows_per_side();
  const std::int64_t block_columns = columns_ - (parts - 1) * step_;
  struct Missing {
    std::int64_t column;
    std::int64_t row;
  };
  std::vector<Missing> missing;
  for (std::int64_t block = first_column_; block < first_column_ + block_columns; ++block) {
    if (!needed(block)) continue;
    for (int part = 0; part < parts * parts; ++part) {
      const std::int64_t window_column = block + part % parts * step_;
      const std::int64_t window_row = row + part / parts * step_;
      Slot& slot = slots_[slot_index(window_column, window_row)];
      if (slot.row == window_row) continue;
      slot.row = window_row;
      missing.push_back({window_column, window_row});
    }
  }
  parallel_for(missing.size(), threads, [&](std::size_t index, int worker) {
    const Missing& window = missing[index];
    Slot& slot = slots_[slot_index(window.column, window.row)];
    if (slot.spectrum.size() == 0) slot.spectrum = AlignedFloats(correlator_.spectrum_size());
    const int side = correlator_.window_px();
    const cv::Mat pixels = strip.centred_window({window.column * stride_px_ - correlator_.radius_px(),
                                                 window.row * stride_px_ - correlator_.radius_px(), side, side});
    correlator_.forward(pixels, workspaces[static_cast<std::size_t>(worker)], slot.spectrum.data());
  });
}

std::vector<const float*> WindowSpectra::of_block(std::int64_t column, std::int64_t row) const {
  const int parts = correlator_.windows_per_side();
  std::vector<const float*> spectra;
  for (int part = 0; part < parts * parts; ++part) {
    spectra.push_back(slots_[slot_index(column + part % parts * step_, row + part / parts * step_)].spectrum.data());
  }
  return spectra;
}

}  // namespace pilotage
