/* Device side of the framed serial DAQ, protocol 1 (docs/daq-stream.md): frames out, command lines in.
 *
 * C99, no allocation, no operating system, no floating point; state is in the caller's structs. Any byte order.
 * Flash on a Cortex-M: about 1 kB.
 *
 * Use: fill a buffer of scans from the converter's interrupt or DMA; in the main loop, encode it with
 * daq_stream_data() into a frame buffer and hand that to the serial port. When there is no room for samples, drop
 * them and say so with daq_stream_lose(): the next frame then carries the overrun flag and its true index.
 */
#ifndef DAQ_STREAM_H
#define DAQ_STREAM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define DAQ_FRAME_OVERHEAD 10u /* sync 2, type, flags, length 2, CRC 4 */
#define DAQ_DATA_HEAD 15u      /* sequence 4, first scan 8, scans 2, channels 1 */
#define DAQ_PAYLOAD_MAX 65535u
#define DAQ_LINE_MAX 16u /* no command is longer */

/* Bytes of a DATA frame: to size its buffer. At most 65535 - 15 bytes of counts fit. */
#define DAQ_DATA_BYTES(scans, channels) \
    (DAQ_FRAME_OVERHEAD + DAQ_DATA_HEAD + 3u * (size_t)(scans) * (size_t)(channels))

/* One stream: what the next DATA frame will say of its place. */
typedef struct {
    uint32_t sequence; /* frames encoded since START */
    uint64_t scan;     /* scans taken since START, lost ones included */
    uint8_t channels;
    bool lost; /* samples were lost since the last frame */
} daq_stream;

/* What the host asks. DAQ_NONE: the line is not complete. */
typedef enum { DAQ_NONE, DAQ_ASK, DAQ_START, DAQ_STOP, DAQ_UNKNOWN } daq_command;

/* The line being heard. */
typedef struct {
    char text[DAQ_LINE_MAX];
    size_t length;
    bool too_long;
} daq_line;

/* Begin a stream at scan 0, as START asks. */
void daq_stream_begin(daq_stream *stream, uint8_t channels);

/* Encode scans x channels counts, scan by scan, each -2^23 .. 2^23 - 1 (beyond is cut to that), as one DATA frame.
 * Returns its length; 0 if `room` bytes are too few or the payload too long: then nothing has changed. */
size_t daq_stream_data(daq_stream *stream, const int32_t *counts, uint16_t scans, uint8_t *out, size_t room);

/* Say that so many scans were taken and lost. */
void daq_stream_lose(daq_stream *stream, uint64_t scans);

/* The other frames. `json`, `text`: UTF-8, ended by a zero. Return the length, or 0 if it does not fit. */
size_t daq_stream_info(const char *json, uint8_t *out, size_t room);
size_t daq_stream_stopped(const daq_stream *stream, uint8_t *out, size_t room);
size_t daq_stream_error(const char *text, uint8_t *out, size_t room);

/* Take one byte from the host; returns a command when it ends a line. Begin with a zeroed daq_line. */
daq_command daq_hear(daq_line *line, char byte);

/* CRC-32 of IEEE 802.3, as zlib's crc32(): begin with 0, go on with what the last call returned. */
uint32_t daq_crc32(uint32_t crc, const uint8_t *data, size_t length);

#endif
