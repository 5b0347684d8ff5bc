// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// IES TM-25-13 ray files (.tm25ray): header, flags, texts, spectral tables, column labels, text, then
/// float32 records.
namespace lucerna {

/// True if the file begins with "TM25".
bool looks_like_tm25(const InputFile& file);

/// Opens a TM-25 file. All of the 2013 edition is read; 2020 with a warning. Weights are the luminous flux
/// column if there is one and the header does not give the watts only; the other flux column is an extra
/// column. The rays are anchored to the end of the file where writers disagree about padding (a warning says
/// so); Stokes vectors of 3 or 6 columns, spectrum indices as float32 or int32. Stated totals of 0, NaN or
/// the byte-swapped NaN mean "not stated". InputError on anything that does not add up, with the byte. Header
/// memory is below 64 MB.
std::unique_ptr<RayReader> open_tm25(InputFile file, const ReadOptions& options = {});

/// Writes TM-25-13. Columns are put into the standard's order; columns that the standard has no place for
/// become additional items with a warning. Count and wavelength range are completed by `finish`.
std::unique_ptr<RayWriter> create_tm25(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options = {});

}  // namespace lucerna
