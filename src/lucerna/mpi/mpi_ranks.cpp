// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mpi/mpi_ranks.h"

#include <mpi.h>

#include <algorithm>
#include <cstdlib>

namespace lucerna {

namespace {

/// Counts of MPI are ints, and libraries are at their best with pieces that fit their buffers many times.
constexpr std::size_t kPiece = std::size_t{1} << 24;
constexpr int kTextTag = 1, kExchangeTag = 2;

}  // namespace

/// The shared counter: 64 bits in the memory of rank 0, which all ranks add to without its help.
struct MpiRanks::Window {
  MPI_Win handle = MPI_WIN_NULL;
  std::int64_t* counter = nullptr;
};

MpiRanks::MpiRanks(int& argc, char**& argv) : window_(std::make_unique<Window>()) {
  int provided = MPI_THREAD_SINGLE;
  MPI_Init_thread(&argc, &argv, MPI_THREAD_SERIALIZED, &provided);
  may_poll_ = provided >= MPI_THREAD_SERIALIZED;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
  MPI_Comm_size(MPI_COMM_WORLD, &size_);
  const MPI_Aint bytes = rank_ == 0 ? sizeof(std::int64_t) : 0;
  MPI_Win_allocate(bytes, sizeof(std::int64_t), MPI_INFO_NULL, MPI_COMM_WORLD, &window_->counter,
                   &window_->handle);
  if (rank_ == 0) {
    MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, window_->handle);
    *window_->counter = 0;
    MPI_Win_unlock(0, window_->handle);
  }
  MPI_Barrier(MPI_COMM_WORLD);
}

MpiRanks::~MpiRanks() {
  MPI_Win_free(&window_->handle);
  MPI_Finalize();
}

std::uint64_t MpiRanks::counter_before_adding(std::int64_t step) {
  std::int64_t before = 0;
  MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, window_->handle);
  MPI_Fetch_and_op(&step, &before, MPI_INT64_T, 0, 0, MPI_SUM, window_->handle);
  MPI_Win_unlock(0, window_->handle);
  return static_cast<std::uint64_t>(before);
}

// 2^40 is beyond all chunks that there can be, and 2^23 ranks may add it.
void MpiRanks::skip_numbers() { counter_before_adding(std::int64_t{1} << 40); }

void MpiRanks::poll() {
  if (!may_poll_) return;
  int found = 0;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &found, MPI_STATUS_IGNORE);
}

std::string MpiRanks::broadcast(const std::string& text) {
  std::string all = text;
  std::uint64_t size = all.size();
  MPI_Bcast(&size, 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  all.resize(size);
  for (std::size_t at = 0; at < size; at += kPiece) {
    const int n = static_cast<int>(std::min(kPiece, size - at));
    MPI_Bcast(all.data() + at, n, MPI_BYTE, 0, MPI_COMM_WORLD);
  }
  return all;
}

std::vector<std::string> MpiRanks::gather(const std::string& text) {
  std::uint64_t size = text.size();
  std::vector<std::uint64_t> sizes(rank_ == 0 ? static_cast<std::size_t>(size_) : 0);
  MPI_Gather(&size, 1, MPI_UINT64_T, sizes.data(), 1, MPI_UINT64_T, 0, MPI_COMM_WORLD);
  if (rank_ != 0) {
    for (std::size_t at = 0; at < size; at += kPiece) {
      const int n = static_cast<int>(std::min<std::size_t>(kPiece, size - at));
      MPI_Send(text.data() + at, n, MPI_BYTE, 0, kTextTag, MPI_COMM_WORLD);
    }
    return {};
  }
  std::vector<std::string> texts{text};
  for (int r = 1; r < size_; ++r) {
    std::string& from = texts.emplace_back(sizes[static_cast<std::size_t>(r)], '\0');
    for (std::size_t at = 0; at < from.size(); at += kPiece) {
      const int n = static_cast<int>(std::min(kPiece, from.size() - at));
      MPI_Recv(from.data() + at, n, MPI_BYTE, r, kTextTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    }
  }
  return texts;
}

std::vector<std::string> MpiRanks::exchange(const std::vector<std::string>& to) {
  std::vector<std::uint64_t> sent, received(to.size());
  for (const std::string& text : to) sent.push_back(text.size());
  MPI_Alltoall(sent.data(), 1, MPI_UINT64_T, received.data(), 1, MPI_UINT64_T, MPI_COMM_WORLD);
  std::vector<std::string> from(to.size());
  std::vector<MPI_Request> requests;
  const auto each_piece = [](std::size_t size, const auto& body) {
    for (std::size_t at = 0; at < size; at += kPiece) body(at, static_cast<int>(std::min(kPiece, size - at)));
  };
  const auto own = static_cast<std::size_t>(rank_);
  for (std::size_t r = 0; r < to.size(); ++r) {
    if (r == own) continue;
    from[r].resize(received[r]);
    each_piece(received[r], [&](std::size_t at, int n) {
      MPI_Irecv(from[r].data() + at, n, MPI_BYTE, static_cast<int>(r), kExchangeTag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  // Each begins with the rank after it, so that not all send to one.
  for (std::size_t k = 1; k < to.size(); ++k) {
    const std::size_t r = (own + k) % to.size();
    each_piece(to[r].size(), [&](std::size_t at, int n) {
      MPI_Isend(to[r].data() + at, n, MPI_BYTE, static_cast<int>(r), kExchangeTag, MPI_COMM_WORLD,
                &requests.emplace_back());
    });
  }
  MPI_Waitall(static_cast<int>(requests.size()), requests.data(), MPI_STATUSES_IGNORE);
  from[own] = to[own];
  return from;
}

void MpiRanks::add_to_first(std::span<std::int64_t> numbers) {
  for (std::size_t at = 0; at < numbers.size(); at += kPiece) {
    const int n = static_cast<int>(std::min(kPiece, numbers.size() - at));
    std::int64_t* const from = numbers.data() + at;
    if (rank_ == 0) {
      MPI_Reduce(MPI_IN_PLACE, from, n, MPI_INT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    } else {
      MPI_Reduce(from, nullptr, n, MPI_INT64_T, MPI_SUM, 0, MPI_COMM_WORLD);
    }
  }
}

void MpiRanks::abort(int exit_code) {
  MPI_Abort(MPI_COMM_WORLD, exit_code);
  std::abort();
}

}  // namespace lucerna
