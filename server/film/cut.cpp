#include "server/film/cut.h"

#include <nlohmann/json.hpp>
#include <span>

#include "server/base/deflate.h"
#include "server/film/film.h"
#include "server/stream/recording_chunk.h"

namespace clothlab::film {

namespace {

std::string deflated(std::string_view bytes) {
  const std::vector<std::uint8_t> made =
      deflate_raw({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
  return {made.begin(), made.end()};
}

Status put_chunk(const Put& put, std::string_view kind, std::string_view head, std::string_view content) {
  for (const std::string_view part :
       {std::string_view(stream::chunk_start(kind, head, content)), head, content})
    if (Status done = put(part); !done) return done;
  return ok();
}

/// The first `kept` frames of a group: each is told by itself or by the one before, never by one that
/// follows.
Status put_part(const Put& put, const Group& group, std::uint32_t kept) {
  const std::string_view all = group.chunk.content;
  const Result<std::string> content = inflated(group.chunk, all.substr(group_head_bytes));
  if (!content) return content.error();
  const std::size_t frames = group.count, count = group.mesh->predictor.vertex_count();
  std::string made;
  std::size_t at = 0;
  // Times, steps, flags, and six planes: lists of all frames.
  for (const std::size_t bytes :
       {std::size_t{8}, std::size_t{8}, std::size_t{1}, count, count, count, count, count, count}) {
    made += content->substr(at, kept * bytes);
    at += frames * bytes;
  }
  if (at < content->size()) {
    nlohmann::json moving = nlohmann::json::parse(content->substr(at), nullptr, false);
    if (!moving.is_array() || moving.size() < kept)
      return damaged(group.chunk.at, "colliders that move, of fewer frames");
    moving.erase(moving.begin() + kept, moving.end());
    made += moving.dump();
  }
  std::string head(reinterpret_cast<const char*>(&kept), sizeof kept);
  head += all.substr(sizeof kept, group_head_bytes - sizeof kept);
  return put_chunk(put, group.chunk.kind, head, deflated(made));
}

}  // namespace

Result<Kept> cut(std::string_view recording, double time, const Put& put) {
  const Result<Reader> reader = Reader::open(recording);
  if (!reader) return reader.error();
  Clock clock(reader->rate());
  std::uint32_t kept = 0;
  double last = 0, seconds = 0;
  for (const Group& group : reader->groups()) {
    const Result<std::vector<Moment>> moments = moments_of(group, false);
    if (!moments) return moments.error();
    for (const Moment& moment : *moments) {
      const double shown = clock.next(moment.time);
      if (shown > time + Clock::rounding) break;
      last = moment.time;
      seconds = shown;
      ++kept;
    }
    if (kept < group.first + group.count) break;
  }
  const Result<std::vector<Chunk>> chunks = chunks_of(recording);
  if (Status done = put(recording.substr(0, chunks->front().at)); !done) return done.error();
  std::size_t group = 0;
  for (const Chunk& chunk : *chunks) {
    const bool frames = chunk.kind == "fram";
    const Group* of = frames ? &reader->groups()[group++] : nullptr;
    if ((of && of->first >= kept) || chunk.kind == "done") break;
    const Status done = of && of->first + of->count > kept ? put_part(put, *of, kept - of->first)
                                                           : put_chunk(put, chunk.kind, "", chunk.content);
    if (!done) return done.error();
  }
  const bool whole = kept == reader->frames();
  const nlohmann::json ending{
      {"time", last}, {"diverged", whole ? reader->diverged() : nullptr}, {"frames", kept}};
  if (Status done = put_chunk(put, "done", "", deflated(ending.dump())); !done) return done.error();
  return Kept{reader->title(), kept, seconds};
}

}  // namespace clothlab::film
