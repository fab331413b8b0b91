#include "daq_stream.h"

#include <string.h>

enum { INFO = 0x01, DATA = 0x02, STOPPED = 0x03, ERROR = 0x7F };
enum { OVERRUN = 0x01 }; /* flag of a DATA frame */
enum { HEADER = 6 };     /* sync, type, flags, length */

#define COUNT_MAX INT32_C(8388607)
#define COUNT_MIN (-COUNT_MAX - 1)

static void put_little_endian(uint8_t *out, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++)
        out[i] = (uint8_t)(value >> (8 * i));
}

static bool fits(size_t payload, size_t room)
{
    return payload <= DAQ_PAYLOAD_MAX && room >= DAQ_FRAME_OVERHEAD + payload;
}

/* Put header and CRC around a payload that stands at out + HEADER already. */
static size_t close_frame(uint8_t type, uint8_t flags, size_t payload, uint8_t *out)
{
    out[0] = 0xA5;
    out[1] = 0x5A;
    out[2] = type;
    out[3] = flags;
    put_little_endian(out + 4, payload, 2);
    put_little_endian(out + HEADER + payload, daq_crc32(0, out + 2, HEADER - 2 + payload), 4);
    return DAQ_FRAME_OVERHEAD + payload;
}

static size_t text_frame(uint8_t type, const char *text, uint8_t *out, size_t room)
{
    const size_t length = strlen(text);
    if (!fits(length, room))
        return 0;
    memcpy(out + HEADER, text, length);
    return close_frame(type, 0, length, out);
}

void daq_stream_begin(daq_stream *stream, uint8_t channels)
{
    stream->sequence = 0;
    stream->scan = 0;
    stream->channels = channels;
    stream->lost = false;
}

size_t daq_stream_data(daq_stream *stream, const int32_t *counts, uint16_t scans, uint8_t *out, size_t room)
{
    const size_t n = (size_t)scans * stream->channels;
    const size_t payload = DAQ_DATA_HEAD + 3 * n;
    if (!fits(payload, room))
        return 0;
    uint8_t *at = out + HEADER;
    put_little_endian(at, stream->sequence, 4);
    put_little_endian(at + 4, stream->scan, 8);
    put_little_endian(at + 12, scans, 2);
    at[14] = stream->channels;
    at += DAQ_DATA_HEAD;
    for (size_t i = 0; i < n; i++, at += 3) {
        const int32_t count = counts[i] > COUNT_MAX ? COUNT_MAX : counts[i] < COUNT_MIN ? COUNT_MIN : counts[i];
        put_little_endian(at, (uint32_t)count, 3); /* two's complement, its upper byte left out */
    }
    const size_t length = close_frame(DATA, stream->lost ? OVERRUN : 0, payload, out);
    stream->sequence++; /* wraps */
    stream->scan += scans;
    stream->lost = false;
    return length;
}

void daq_stream_lose(daq_stream *stream, uint64_t scans)
{
    stream->scan += scans;
    stream->lost = true;
}

size_t daq_stream_info(const char *json, uint8_t *out, size_t room)
{
    return text_frame(INFO, json, out, room);
}

size_t daq_stream_stopped(const daq_stream *stream, uint8_t *out, size_t room)
{
    if (!fits(8, room))
        return 0;
    put_little_endian(out + HEADER, stream->scan, 8);
    return close_frame(STOPPED, 0, 8, out);
}

size_t daq_stream_error(const char *text, uint8_t *out, size_t room)
{
    return text_frame(ERROR, text, out, room);
}

static bool is(const daq_line *line, const char *word)
{
    return !line->too_long && line->length == strlen(word) && memcmp(line->text, word, line->length) == 0;
}

daq_command daq_hear(daq_line *line, char byte)
{
    if (byte != '\n') {
        if (line->length < DAQ_LINE_MAX)
            line->text[line->length++] = byte;
        else
            line->too_long = true;
        return DAQ_NONE;
    }
    const daq_command command = is(line, "ID?")     ? DAQ_ASK
                                : is(line, "START") ? DAQ_START
                                : is(line, "STOP")  ? DAQ_STOP
                                                    : DAQ_UNKNOWN;
    line->length = 0;
    line->too_long = false;
    return command;
}

uint32_t daq_crc32(uint32_t crc, const uint8_t *data, size_t length)
{
    /* A table of 16 instead of 256 entries: two steps a byte, 64 bytes of flash. Use the hardware's where there is one:
     * polynomial 04C11DB7 reflected (EDB88320), start and final xor FFFFFFFF. */
    static const uint32_t table[16] = {
        0x00000000, 0x1DB71064, 0x3B6E20C8, 0x26D930AC, 0x76DC4190, 0x6B6B51F4, 0x4DB26158, 0x5005713C,
        0xEDB88320, 0xF00F9344, 0xD6D6A3E8, 0xCB61B38C, 0x9B64C2B0, 0x86D3D2D4, 0xA00AE278, 0xBDBDF21C,
    };
    crc = ~crc;
    for (size_t i = 0; i < length; i++) {
        crc ^= data[i];
        crc = (crc >> 4) ^ table[crc & 15];
        crc = (crc >> 4) ^ table[crc & 15];
    }
    return ~crc;
}
